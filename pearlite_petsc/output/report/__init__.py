"""The report of a result: what it says (validity, conclusions) and how it looks (page)."""
