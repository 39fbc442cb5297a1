"""A crack's length over its cycles, as a laboratory or this program writes it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.growth_rate import advances
from pearlite_petsc.output.user_table import UserTable, parse_number, parse_table, read_text

CYCLES, DELTA_K = "cycles", "delta_k_mpa_sqrt_m"
LENGTHS = {"crack_length_um": 1.0, "crack_length_mm": 1e3}
"""Columns that may hold the crack's length, and what they are in um."""

LARGEST_CYCLES, LARGEST_LENGTH, LARGEST_DELTA_K = 1e12, 1e7, 1e4


@dataclass(frozen=True, slots=True, eq=False)
class LengthHistory:
    """Measurements of one crack: the first one, and each that found it longer than all before.

    Attributes:
        cycles: N; (p,).
        crack_length: a [um]; (p,).
        delta_k: Delta-K at each [MPa sqrt(m)], None where the file has none; (p,).
        passed_over: Rows at which the crack was not longer than before.
        notes: What was not read as it stands in the file.
    """

    cycles: FloatArray
    crack_length: FloatArray
    delta_k: FloatArray | None
    passed_over: int
    notes: tuple[str, ...]


def read_lengths(path: Path) -> LengthHistory:
    """Return the measurements of a CSV file with ``cycles`` and ``crack_length_um`` or ``_mm``.

    ``delta_k_mpa_sqrt_m`` may be there; other columns are ignored, so that the program's own
    ``growth/*.csv`` can be given as well.

    Args:
        path: The file.

    Raises:
        SceneError: A column is missing, a value cannot be used, the cycles fall, or the crack never
            got longer; the message names line and column.
    """
    text = read_text(path, "lengths over cycles")
    length_column = _length_column(text)
    columns = (CYCLES, length_column)
    table = parse_table(text, str(path), columns, (*columns, DELTA_K), "measurements")
    if all(name in table.columns for name in LENGTHS):
        raise SceneError(f"{path}: {' and '.join(LENGTHS)} are both given, only one is needed")
    factor = LENGTHS[length_column]
    cycles = _column(table, CYCLES, LARGEST_CYCLES, zero=True)
    length = factor * _column(table, length_column, LARGEST_LENGTH / factor)
    delta_k = _column(table, DELTA_K, LARGEST_DELTA_K) if DELTA_K in table.columns else None
    falls = np.flatnonzero(np.diff(cycles) < 0.0)
    if len(falls):
        before, row = table.rows[falls[0]], table.rows[falls[0] + 1]
        raise SceneError(
            f"{table.where(row)}: cycles = {row.fields[CYCLES]} after {before.fields[CYCLES]}; "
            "they must not fall, and one file holds one crack"
        )
    chosen = advances(length)
    if chosen.sum() < 2:
        raise SceneError(f"{path}: the crack got longer at none of its {len(length)} rows")
    return LengthHistory(
        cycles[chosen],
        length[chosen],
        None if delta_k is None else delta_k[chosen],
        int((~chosen).sum()),
        table.notes,
    )


def _length_column(text: str) -> str:
    head = text.lstrip().splitlines()[0] if text.strip() else ""
    return next((name for name in LENGTHS if name in head), next(iter(LENGTHS)))


def _column(table: UserTable, name: str, largest: float, zero: bool = False) -> FloatArray:
    return np.array(
        [
            parse_number(row.fields[name], name, table.where(row), largest, zero)
            for row in table.rows
        ]
    )
