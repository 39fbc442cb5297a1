"""A claim with what was expected and measured, and the sections that claims come in."""

from dataclasses import dataclass, field
from enum import IntEnum
from pathlib import Path

import numpy as np


class Effort(IntEnum):
    """How much is computed: seconds, minutes, up to an hour."""

    QUICK = 0
    NORMAL = 1
    LONG = 2


@dataclass(frozen=True, slots=True)
class Setting:
    """What a section is asked for.

    Attributes:
        effort: How much to compute.
        folder: Where its figures go.
    """

    effort: Effort
    folder: Path

    def pick(self, quick: int, normal: int, long: int | None = None) -> int:
        """Return the number that belongs to the effort."""
        numbers = (quick, normal, normal if long is None else long)
        return numbers[self.effort]


@dataclass(frozen=True, slots=True)
class Claim:
    """One line of the table.

    Attributes:
        statement: What should hold.
        source: Equation or handbook.
        expected, measured, tolerance: As the reader sees them.
        holds: Whether it does.
    """

    statement: str
    source: str
    expected: str
    measured: str
    tolerance: str
    holds: bool


@dataclass(slots=True)
class Section:
    """Claims of one kind with what else the reader should see.

    Attributes:
        title: Heading.
        text: Paragraphs and tables (Markdown) under the claims.
        claims: Lines of the table.
        figures: File name (without suffix) -> caption.
        left_out: What could not be compared here, and why.
    """

    title: str
    text: list[str] = field(default_factory=list)
    claims: list[Claim] = field(default_factory=list)
    figures: dict[str, str] = field(default_factory=dict)
    left_out: list[str] = field(default_factory=list)

    def close(
        self, statement: str, source: str, expected: float, measured: float, tolerance: float
    ) -> None:
        """Claim that a number lies within an absolute tolerance of the expected one."""
        holds = bool(abs(measured - expected) <= tolerance)
        shown = number(expected), number(measured), f"+-{number(tolerance)}"
        self.claims.append(Claim(statement, source, *shown, holds))

    def below(self, statement: str, source: str, measured: float, limit: float) -> None:
        """Claim that an error is 0 but for a limit."""
        holds = bool(measured <= limit)
        self.claims.append(
            Claim(statement, source, "0", number(measured), f"< {number(limit)}", holds)
        )

    def above(self, statement: str, source: str, measured: float, limit: float) -> None:
        """Claim that a number reaches a limit."""
        holds = bool(measured >= limit)
        shown = f">= {number(limit)}", number(measured)
        self.claims.append(Claim(statement, source, *shown, "none", holds))

    def true(self, statement: str, source: str, expected: str, measured: str, holds: bool) -> None:
        """Claim something that no single number says."""
        self.claims.append(Claim(statement, source, expected, measured, "exact", bool(holds)))

    def table(self, head: list[str], rows: list[list[str]]) -> None:
        """Add a table to the text."""
        lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
        self.text.append("\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)]))


def number(value: float) -> str:
    """Return a number as a reader likes it: four digits, small ones by their power of ten."""
    if value == 0.0 or not np.isfinite(value):
        return f"{value:g}"
    return f"{value:.1e}" if abs(value) < 1e-3 else f"{value:.4g}"


def fitted_order(sizes: list[float], errors: list[float]) -> float:
    """Return p of error ~ size^p by least squares in logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])
