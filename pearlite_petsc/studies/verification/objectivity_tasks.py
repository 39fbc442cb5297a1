"""The same microstructures at several element widths: tasks, and their rates as a table."""

import csv
import os
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Literal

from pearlite_petsc.errors import MeshError, SolverError
from pearlite_petsc.fatigue.damage import OBJECTIVE, PRINTED
from pearlite_petsc.scene import Damage, Solver, State
from pearlite_petsc.studies.cases import STATES, scene_of
from pearlite_petsc.studies.table import write_rows

WIDTHS = (2.0, 3.0, 4.0)
FEW_WIDTHS = (1.5, 6.0)
MESHES, FEW_MESHES = 20, 4
Variant = Literal["objective", "printed", "one_kind"]
VARIANTS: tuple[Variant, ...] = ("objective", "printed", "one_kind")
"""Both laws, and ``objective`` with cementite as weak as ferrite: no interface is a barrier."""

DELTA_K = 2e4
EXTENSION = 40.0


@dataclass(frozen=True, slots=True)
class Rate:
    """Outcome of one task.

    Attributes:
        state, mesh, law: The task.
        width: Of the square elements [um].
        da_dn: [um/cycle], NaN where nothing grew.
        stop_reason: Why it ended; "no mesh" where the notch could not be meshed, "failed" where no
            equilibrium was found.
        tortuosity: Path over x-extent; 0 where the crack is too short for one.
        solves: Linear solves.
    """

    state: str
    mesh: int
    law: Variant
    width: float
    da_dn: float
    stop_reason: str
    tortuosity: float
    solves: int


def tasks() -> list[tuple[str, int, float]]:
    """Return (state, mesh, width) of all tasks, those with many elements first."""
    few = [
        (name, index, width)
        for width in FEW_WIDTHS
        for index in range(FEW_MESHES)
        for name in STATES
    ]
    many = [(name, index, width) for width in WIDTHS for index in range(MESHES) for name in STATES]
    return sorted(few + many, key=lambda task: task[2])


def grow_variants(
    task: tuple[str, int, float], variants: Sequence[Variant] = VARIANTS
) -> list[Rate]:
    """Grow the crack of one microstructure at one width under all damage laws."""
    # Here, so that a new process starts MPI in its own time.
    from pearlite_petsc.growth.prepared import prepare_growth
    from pearlite_petsc.studies.growing import grow_alone

    name, index, width = task
    # The table compares the laws under the kinds that all its rows have; `bench widths` compares
    # element sizes under any.
    size = (width, width)
    base = scene_of(size=size, refinement="follow", extension=EXTENSION, kinds="labels")
    base = replace(base, solver=Solver("iterative", 1e-8, 5000))
    try:
        prepared = prepare_growth(base, STATES[name], index)
    except MeshError:
        return [Rate(name, index, law, width, float("nan"), "no mesh", 0.0, 0) for law in variants]
    rates = []
    for law in variants:
        scene = replace(base, damage=damage_of(base.damage, law, STATES[name]))
        try:
            found = grow_alone(scene, STATES[name], DELTA_K, prepared)
        except SolverError:
            rates.append(Rate(name, index, law, width, float("nan"), "failed", 0.0, 0))
            continue
        rates.append(
            Rate(
                name,
                index,
                law,
                width,
                found.da_dn,
                found.stop_reason.value,
                found.tortuosity or 0.0,
                found.effort.solves,
            )
        )
    return rates


def damage_of(damage: Damage, variant: Variant, state: State) -> Damage:
    """Return the damage constants of a variant."""
    if variant == "one_kind":
        return replace(damage, law=OBJECTIVE, cementite_strength=state.yield_stress)
    return replace(damage, law=PRINTED if variant == "printed" else OBJECTIVE)


def compute_rates(
    chosen: Sequence[tuple[str, int, float]], unfinished: Path, processes: int = 0
) -> list[Rate]:
    """Compute tasks in processes of their own, by default one a core.

    Args:
        chosen: Tasks.
        unfinished: Keeps what is done, so that an interrupted computation goes on; removed at the
            end.
        processes: How many, 0 for one a core.
    """
    rates = read_rates(unfinished) if unfinished.is_file() else []
    done = {(rate.state, rate.mesh, rate.width) for rate in rates}
    left = [task for task in chosen if task not in done]
    workers = processes or os.cpu_count() or 1
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for found in pool.map(grow_variants, left):
            rates += found
            write_rates(unfinished, rates)
    unfinished.unlink(missing_ok=True)
    return rates


def write_rates(path: Path, rates: Iterable[Rate]) -> None:
    """Write the rates as CSV."""
    write_rows(path, [asdict(rate) for rate in rates])


def read_rates(path: Path) -> list[Rate]:
    """Read what ``write_rates`` wrote."""
    with path.open(newline="", encoding="utf-8") as file:
        return [
            Rate(
                row["state"],
                int(row["mesh"]),
                next(variant for variant in VARIANTS if variant == row["law"]),
                float(row["width"]),
                float(row["da_dn"]),
                row["stop_reason"],
                float(row["tortuosity"]),
                int(row["solves"]),
            )
            for row in csv.DictReader(file)
        ]
