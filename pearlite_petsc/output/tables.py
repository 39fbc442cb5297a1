"""CSV tables: one row per task (``fcg.csv``), one file per crack (``growth/*.csv``), one row per
point (``da_dn.csv``).

Inside: um, MPa sqrt(um). In the tables: da/dN in m/cycle, Delta-K in MPa sqrt(m), lengths in um.
"""

import csv
import math
from collections.abc import Iterable, Sequence
from decimal import Decimal
from pathlib import Path

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.growth_rate import advances, incremental_polynomial, secant
from pearlite_petsc.fatigue.outcome import Effort, Outcome, StopReason
from pearlite_petsc.output.whole_file import whole_file
from pearlite_petsc.scene import Scene

MPA_SQRT_UM = 1000.0
"""1 MPa sqrt(m) in MPa sqrt(um)."""

UM_PER_M = 1e6

FCG_COLUMNS = (
    "state",
    "mesh",
    "delta_k_mpa_sqrt_m",
    "da_dn_m_per_cycle",
    "cycles",
    "extension_um",
    "tortuosity",
    "stop_reason",
    "solves",
    "wall_s",
)
GROWTH_COLUMNS = (
    "cycles",
    "crack_length_um",
    "path_length_um",
    "broken_interfaces",
    "k_1_over_delta_k",
    "k_2_over_delta_k",
    "k_misfit",
)
RATE_COLUMNS = (
    "state",
    "mesh",
    "delta_k_mpa_sqrt_m",
    "crack_length_um",
    "secant_m_per_cycle",
    "polynomial_m_per_cycle",
)


def delta_k_in_mpa_sqrt_m(delta_k: float) -> float:
    """Return MPa sqrt(m) from MPa sqrt(um), without the last digits' noise of the conversion."""
    return float(f"{delta_k / MPA_SQRT_UM:.14g}")


def delta_k_from_mpa_sqrt_m(value: float) -> float:
    """Return MPa sqrt(um) from MPa sqrt(m), the very number that a scene with that value has.

    >>> 1.001 * MPA_SQRT_UM, delta_k_from_mpa_sqrt_m(1.001)
    (1000.9999999999999, 1001.0)
    """
    return float(Decimal(repr(value)).scaleb(3))


def task_name(state: str, mesh_index: int, delta_k: float) -> str:
    """Return the stem of a task's files, ``<state>_m<index>_dk<value in MPa sqrt(m)>``.

    Args:
        state: Name of the state.
        mesh_index: Number of the mesh.
        delta_k: [MPa sqrt(um)].
    """
    return f"{state}_m{mesh_index}_dk{delta_k_in_mpa_sqrt_m(delta_k):.12g}"


def middle_delta_k(scene: Scene) -> float:
    """Return the delta_k whose cracks are shown where one has to do [MPa sqrt(um)]."""
    levels = sorted(scene.loading.delta_k)
    return levels[len(levels) // 2]


def in_order(outcomes: Iterable[Outcome], states: Sequence[str]) -> list[Outcome]:
    """Return the outcomes by state (as listed, unknown ones last), mesh, delta_k."""
    rank = {name: place for place, name in enumerate(states)}
    return sorted(
        outcomes, key=lambda o: (rank.get(o.state, len(rank)), o.state, o.mesh_index, o.delta_k)
    )


def write_fcg(path: Path, outcomes: Iterable[Outcome], states: Sequence[str]) -> None:
    """Write one row per task, failed ones included; numbers in full precision.

    da/dN is ``nan`` where nothing grew or the crack arrested; the tortuosity is empty where it is not defined.

    Args:
        path: ``fcg.csv``.
        outcomes: Tasks in any order.
        states: Names of the states in the order wanted.
    """
    with whole_file(path) as partial, partial.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(FCG_COLUMNS)
        for o in in_order(outcomes, states):
            writer.writerow(
                (
                    o.state,
                    o.mesh_index,
                    repr(delta_k_in_mpa_sqrt_m(o.delta_k)),
                    repr(float(o.da_dn) / UM_PER_M),
                    repr(float(o.cycles)),
                    repr(float(o.extension)),
                    "" if o.tortuosity is None else repr(float(o.tortuosity)),
                    o.stop_reason.value,
                    o.effort.solves,
                    repr(float(o.effort.wall_s)),
                )
            )


def write_da_dn(path: Path, outcomes: Iterable[Outcome], states: Sequence[str]) -> None:
    """Write da/dN of every crack point by point, evaluated as in a laboratory (ASTM E647).

    A row for each moment at which a crack got longer, the first row of each crack its start; a rate
    that a method does not have there is ``nan``.

    Args:
        path: ``da_dn.csv``.
        outcomes: Tasks in any order; those without a history have no rows.
        states: Names of the states in the order wanted.
    """
    with whole_file(path) as partial, partial.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(RATE_COLUMNS)
        for o in in_order(outcomes, states):
            if o.history is None:
                continue
            cycles, length = o.history[advances(o.history[:, 1]), :2].T
            rates = secant(cycles, length), incremental_polynomial(cycles, length)
            task = o.state, o.mesh_index, repr(delta_k_in_mpa_sqrt_m(o.delta_k))
            writer.writerows(
                (*task, repr(a), repr(one / UM_PER_M), repr(other / UM_PER_M))
                for a, one, other in zip(length.tolist(), *(r.tolist() for r in rates), strict=True)
            )


def read_fcg(path: Path) -> list[Outcome]:
    """Return the tasks of an ``fcg.csv``, without histories and paths.

    Raises:
        SceneError: The file is missing, or a column or value is not what ``write_fcg`` writes.
    """
    try:
        with path.open(newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise SceneError(f"{path}: cannot be read ({error})") from None
    outcomes = []
    for number, row in enumerate(rows, start=2):
        try:
            outcomes.append(_outcome(row))
        except (KeyError, TypeError, ValueError) as error:
            raise SceneError(f"{path}: line {number} is not a row of fcg.csv ({error})") from None
    return outcomes


def _outcome(row: dict[str, str]) -> Outcome:
    tortuosity = float(row["tortuosity"]) if row["tortuosity"] else math.nan
    return Outcome(
        state=row["state"],
        mesh_index=int(row["mesh"]),
        delta_k=delta_k_from_mpa_sqrt_m(float(row["delta_k_mpa_sqrt_m"])),
        stop_reason=StopReason(row["stop_reason"]),
        cycles=float(row["cycles"]),
        extension=float(row["extension_um"]),
        da_dn=float(row["da_dn_m_per_cycle"]) * UM_PER_M,
        tortuosity=None if math.isnan(tortuosity) else tortuosity,
        effort=Effort(solves=int(row["solves"]), wall_s=float(row["wall_s"])),
    )


def write_growth(folder: Path, outcome: Outcome) -> Path | None:
    """Write ``<folder>/<task>.csv``, the crack's history; None if the task has none.

    Args:
        folder: ``growth`` of the result.
        outcome: Task with ``history``.
    """
    if outcome.history is None:
        return None
    name = task_name(outcome.state, outcome.mesh_index, outcome.delta_k)
    path = folder / f"{name}.csv"
    with whole_file(path) as partial, partial.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(GROWTH_COLUMNS)
        writer.writerows(
            (repr(cycles), repr(length), repr(way), int(broken), *map(repr, tip))
            for cycles, length, way, broken, *tip in outcome.history.tolist()
        )
    return path


def read_growth(path: Path) -> FloatArray:
    """Return the history of a ``growth/*.csv``; columns as ``GROWTH_COLUMNS``, shape (h, 7).

    Those that files of 0.1.0 have not got are NaN.
    """
    columns = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2, dtype=np.float64)
    missing = np.full((len(columns), len(GROWTH_COLUMNS) - columns.shape[1]), np.nan)
    return np.hstack([columns, missing])
