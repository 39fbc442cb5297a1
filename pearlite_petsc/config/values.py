"""One value of a scene file: checked against its key and converted, both ways, exactly.

Numbers are read as decimals and units differ by powers of ten, so that writing a scene and
reading it again gives the same bits.
"""

import math
from decimal import Decimal
from typing import Any

from pearlite_petsc.laws.key import Key, scaled

MOST_NUMBERS = 200
LONGEST_TEXT = 1000


def parse_number(text: str) -> Decimal:
    """Return a TOML float as the decimal that is written there; infinite beyond a float's range."""
    number = float(text)
    # Decimal itself refuses exponents of twenty digits.
    return Decimal(text) if math.isfinite(number) and number != 0 else Decimal(number)


def plain(text: str, limit: int = 200) -> str:
    """Return the text as one printable line.

    >>> plain("one\\nline")
    'one\\\\nline'
    """
    line = text if text.isprintable() else ascii(text)[1:-1]
    return line if len(line) <= limit else line[: limit - 3] + "..."


def show(value: Any, limit: int = 60) -> str:
    """Return the value as one short printable line for a message."""
    if isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, int) and abs(value) >= 10**30:
        text = f"a whole number of {value.bit_length()} bits"
    elif isinstance(value, list | tuple):
        items = ", ".join(show(item, limit) for item in value[:8])
        text = f"[{items}{', ...' if len(value) > 8 else ''}]"
    elif isinstance(value, dict):
        text = "a table"
    elif isinstance(value, str):
        text = f'"{plain(value, limit)}"'
    else:
        text = plain(str(value), limit)
    return text


def program_value(key: Key, value: Any) -> Any:
    """Return the value in the program's unit.

    Args:
        key: What is allowed.
        value: As read from TOML, floats as ``Decimal``.

    Returns:
        float, int, bool, str (None if empty) or tuple of floats.

    Raises:
        ValueError: If it is not allowed; the message starts with the value and holds the limit.
    """
    match key.type:
        case "boolean":
            if not isinstance(value, bool):
                raise ValueError(f"= {show(value)} must be true or false")
            return value
        case "text":
            return _text(key, value)
        case "integer":
            return _integer(key, value)
        case "number":
            return _number(key, value)
        case "numbers":
            return _numbers(key, value)


def file_text(key: Key, value: Any) -> str:
    """Return the program's value as TOML text in the file's unit; ``program_value``'s inverse."""
    match key.type:
        case "boolean":
            return "true" if value else "false"
        case "integer":
            return str(value)
        case "text":
            return '"' + str(value or "").replace("\\", "\\\\").replace('"', '\\"') + '"'
        case "number":
            return _number_text(value, key.power)
        case "numbers":
            return "[" + ", ".join(_number_text(item, key.power) for item in value) + "]"


def _text(key: Key, value: Any) -> str | None:
    if not isinstance(value, str):
        raise ValueError(f"= {show(value)} is not a text, write it in quotes")
    if key.choices and value not in key.choices:
        words = ", ".join(f'"{word}"' for word in key.choices)
        raise ValueError(f"= {show(value)} must be one of {words}")
    if not value.isprintable() or len(value) > LONGEST_TEXT:
        raise ValueError(f"= {show(value)} must be printable and at most {LONGEST_TEXT} long")
    return value or None


def _integer(key: Key, value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"= {show(value)} is not a whole number")
    if key.limits is not None and not key.limits.hold(value):
        raise ValueError(f"= {show(value)} must be {key.limits}")
    return value


def _number(key: Key, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | Decimal):
        raise ValueError(f"= {show(value)} is not a number")
    if isinstance(value, float | Decimal) and not math.isfinite(value):
        raise ValueError(f"= {show(value)} is not a finite number")
    # The limits are floats: 0.01 as a decimal lies below 0.01 as a float.
    rounded = float(value) if isinstance(value, Decimal) else value
    if key.limits is not None and not key.limits.hold(rounded):
        raise ValueError(f"= {show(value)} must be {key.limits}")
    return scaled(value, key.power)


def _numbers(key: Key, value: Any) -> tuple[float, ...]:
    if not isinstance(value, list | tuple):
        raise ValueError(f"= {show(value)} must be a list of numbers, such as [8.0, 12.0]")
    if not value:
        raise ValueError("= [] is empty, at least one value is needed")
    if len(value) > MOST_NUMBERS:
        raise ValueError(f"has {len(value)} values, at most {MOST_NUMBERS} are allowed")
    numbers: dict[str, float] = {}
    for position, item in enumerate(value, start=1):
        try:
            number = _number(key, item)
        except ValueError as error:
            raise ValueError(f"value {position} {error}") from None
        # The name of a task's files holds six digits of it.
        if f"{number:.6g}" in numbers:
            raise ValueError(f"value {position} = {show(item)} is there twice")
        numbers[f"{number:.6g}"] = number
    return tuple(numbers.values())


def _number_text(value: float, power: int) -> str:
    decimal = Decimal(repr(value)).scaleb(-power).normalize()
    if decimal and not -6 < decimal.adjusted() < 16:
        return f"{decimal:e}"
    text = f"{decimal:f}"
    return text if "." in text else text + ".0"
