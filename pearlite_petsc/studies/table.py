"""Tables of studies: CSV files and aligned text."""

import csv
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from pearlite_petsc.output.whole_file import whole_file

Row = Mapping[str, str | int | float | bool]


def write_rows(path: Path, rows: Sequence[Row]) -> None:
    """Write rows with the same columns; floats with six digits."""
    with whole_file(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({name: shown(value) for name, value in row.items()})


def say(text: str) -> None:
    """Write a line for the one who waits."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def shown(value: str | int | float | bool) -> str:
    """Return a value as in the tables."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
