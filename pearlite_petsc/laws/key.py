"""Keys of scene files: name with unit, type, limits, default and meaning of one value.

They make up the program's own tables and the parameters of damage, spring and cycle jump laws.
"""

from dataclasses import dataclass
from decimal import Decimal
from typing import Any, Literal

Type = Literal["number", "integer", "boolean", "text", "numbers"]

UNITS = {
    "": 0,
    "nm": -3,
    "um": 0,
    "mm": 3,
    "mpa": 0,
    "gpa": 3,
    "mpa_per_um": 0,
    "mpa_sqrt_m": 3,
    "um5_per_n2": -12,
}
"""Units that a key may end in, each with the power of ten that converts it to the program's own
units (um, MPa, uN): 1 GPa is 10^3 MPa.
"""


@dataclass(frozen=True, slots=True)
class Limits:
    """Range of a number in the file's unit; an open end is excluded."""

    low: float
    high: float
    open_low: bool = False
    open_high: bool = False

    def hold(self, value: Any) -> bool:
        """Return whether the number lies inside; False for NaN."""
        above = value > self.low if self.open_low else value >= self.low
        below = value < self.high if self.open_high else value <= self.high
        return bool(above and below)

    def __str__(self) -> str:
        low = f"above {self.low:.12g}" if self.open_low else f"at least {self.low:.12g}"
        high = f"below {self.high:.12g}" if self.open_high else f"at most {self.high:.12g}"
        return f"{low} and {high}"


LENGTH = Limits(0.01, 1e5)
"""Limits of lengths [um]."""

SHARE = Limits(0.0, 1.0, open_low=True)
"""Limits of shares of a whole, 0 excluded."""


@dataclass(frozen=True, slots=True)
class Key:
    """One key of a table.

    Attributes:
        name: Name in the file, ending in the unit.
        attribute: Name of the attribute of the table's dataclass, or of the keyword of the law's
            function.
        type: Type of the value; "numbers" is a list of numbers.
        default: Default value in the file's unit.
        help: What the key means, with the unit; the comment beside it in written scenes.
        power: The program's value is the file's value times 10**power.
        limits: Limits of a number, an integer or each of several numbers, in the file's unit.
        choices: Words that are allowed; all words if empty.
    """

    name: str
    attribute: str
    type: Type
    default: Any
    help: str
    power: int = 0
    limits: Limits | None = None
    choices: tuple[str, ...] = ()

    @property
    def program_default(self) -> Any:
        """The default in the program's unit."""
        if self.type == "number":
            return scaled(self.default, self.power)
        if self.type == "numbers":
            return tuple(scaled(value, self.power) for value in self.default)
        return self.default


def scaled(value: float | Decimal, power: int) -> float:
    """Return the value times 10**power, rounded once.

    >>> scaled(0.1, 3)
    100.0
    """
    decimal = Decimal(repr(value)) if isinstance(value, float) else Decimal(value)
    return float(decimal.scaleb(power)) + 0.0  # + 0.0 makes -0.0 the one zero


def number(attribute: str, default: float, help: str, limits: Limits, unit: str = "") -> Key:
    """Return a key whose value is a number.

    Args:
        attribute: Name in the program; the name in the file also ends in the unit.
        default: Default value, in the unit.
        help: What the key means, with the unit; the comment in written scenes.
        limits: Limits of the value, in the unit.
        unit: One of ``UNITS``; "" for a number without a unit.

    Raises:
        ValueError: The unit is unknown, or the default lies outside the limits.

    Examples:
        >>> key = number("thickness", 20.0, "of the film, nm", Limits(1.0, 500.0), "nm")
        >>> key.name, key.program_default
        ('thickness_nm', 0.02)
    """
    if unit not in UNITS:
        known = ", ".join(f'"{unit}"' for unit in UNITS)
        raise ValueError(f'{attribute}: unit "{unit}" is unknown, known are {known}')
    if not limits.hold(default):
        raise ValueError(f"{attribute}: the default {default:g} must be {limits}")
    name = f"{attribute}_{unit}" if unit else attribute
    return Key(name, attribute, "number", default, help, UNITS[unit], limits)


def integer(attribute: str, default: int, help: str, low: int, high: int) -> Key:
    """Return a key whose value is a whole number from ``low`` to ``high``."""
    return Key(attribute, attribute, "integer", default, help, 0, Limits(low, high))


def word(attribute: str, help: str, *choices: str) -> Key:
    """Return a key whose value is one of several words; the first is the default."""
    return Key(attribute, attribute, "text", choices[0], help, choices=choices)


def switch(attribute: str, default: bool, help: str) -> Key:
    """Return a key whose value is true or false."""
    return Key(attribute, attribute, "boolean", default, help)
