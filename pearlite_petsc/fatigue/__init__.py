"""Damage laws, cycle jump, crack, growth rate (pure numpy)."""
