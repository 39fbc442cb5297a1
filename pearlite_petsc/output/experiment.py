"""A user's own measured points: CSV with state, delta_k_mpa_sqrt_m, da_dn_m_per_cycle."""

import csv
import difflib
import math
from dataclasses import dataclass
from pathlib import Path

from pearlite_petsc.errors import SceneError

COLUMNS = ("state", "delta_k_mpa_sqrt_m", "da_dn_m_per_cycle")


@dataclass(frozen=True, slots=True)
class MeasuredPoint:
    """One measured rate: state, Delta-K [MPa sqrt(m)], da/dN [m/cycle]."""

    state: str
    delta_k: float
    da_dn: float


def read_experiment(path: Path) -> list[MeasuredPoint]:
    """Return the measured points of a CSV file; further columns are ignored.

    Raises:
        SceneError: The file is missing or no text, a column is missing, a number is not positive
            and finite, or there is no point at all.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            reader = csv.DictReader(stream, skipinitialspace=True)
            names = [name.strip() for name in reader.fieldnames or ()]
            reader.fieldnames = names
            rows = list(reader)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise SceneError(f"{path}: measured points cannot be read ({error})") from None
    for column in COLUMNS:
        if column not in names:
            near = difflib.get_close_matches(column, names, 1)
            hint = f", is {near[0]!r} meant?" if near else f"; found {', '.join(names) or 'none'}"
            raise SceneError(f"{path}: column {column!r} is missing{hint}")
    points = [_point(path, line, row) for line, row in enumerate(rows, start=2)]
    if not points:
        raise SceneError(f"{path}: no measured points below the head line")
    return points


def _point(path: Path, line: int, row: dict[str, str | None]) -> MeasuredPoint:
    state = (row["state"] or "").strip()
    if not state:
        raise SceneError(f"{path}: line {line}: state is empty")
    numbers = []
    for column in COLUMNS[1:]:
        text = (row[column] or "").strip()
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not 0.0 < value < math.inf:
            raise SceneError(f"{path}: line {line}: {column} = {text!r} is not a positive number")
        numbers.append(value)
    return MeasuredPoint(state, numbers[0], numbers[1])
