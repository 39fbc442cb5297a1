"""One method on one body, in a process group of its own, so that its peak memory is its own."""

import json
import resource
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from mpi4py import MPI

from pearlite_petsc.scene import Kind
from pearlite_petsc.studies.benchmarks.solver_bodies import Body, read_body
from pearlite_petsc.studies.benchmarks.solver_methods import method_of, missing

SLOW = 10.0
"""Seconds of a first solve from which one warm solve is enough."""

MOST_REPEATS, ENOUGH_SECONDS = 6, 20.0


def measure(comm: MPI.Comm, body: Body, method: str, cracked: bool) -> dict[str, float]:
    """Return iterations, processor times [s] and residual of one method on one body. Collective.

    Args:
        comm: The ranks.
        body: This rank's.
        method: "default", "factors", "GAMG", "hypre", "MUMPS" or "PyAMG".
        cracked: Whether the notch is open; otherwise the body is intact.
    """
    here, load = body.subdomain, body.load()
    damage = ((here.interfaces.kind == Kind.NOTCH) & cracked).astype(float)

    def timed(run: Callable[[], Any]) -> tuple[float, Any]:
        comm.Barrier()
        started = process_time()
        value = run()
        return float(comm.allreduce(process_time() - started, MPI.MAX)), value

    with closing(method_of(comm, here, damage, method)) as solver:
        tries: list[tuple[float, float]] = []
        while len(tries) < MOST_REPEATS and np.sum(tries) < ENOUGH_SECONDS:
            setup, _ = timed(solver.set_up)
            first, iterations = timed(lambda: solver.first_solve(load))
            tries.append((setup, first))
        setup, first = map(min, zip(*tries, strict=True))
        residual = solver.residual()
        solver.begin_warm(load)
        warm, warm_iterations = 0.0, []
        breaks = body.breaks[:1] if first > SLOW else body.breaks
        for number in breaks:
            damage = np.where(here.interfaces.numbers == number, 1.0, damage)
            update, _ = timed(lambda damage=damage: solver.update(damage))  # type: ignore[misc]
            solver.prepare()
            seconds, count = timed(lambda: solver.warm_solve(load))
            warm += (update + seconds) / len(breaks)
            warm_iterations.append(count)
    return {
        "unknowns": 3 * here.element_count,
        "iterations": iterations,
        "setup_s": setup,
        "first_solve_s": first,
        "solution_s": setup + first,
        "warm_solve_s": warm,
        "warm_iterations": float(np.mean(warm_iterations)) if min(warm_iterations) >= 0 else -1.0,
        "residual": residual,
    }


def write_case(comm: MPI.Comm, folder: Path, method: str, result: Path) -> None:
    """Measure a method on an intact and a cracked body; the first rank writes both as JSON.

    Collective.

    Args:
        comm: The ranks.
        folder: Of the bodies that ``write_bodies`` made for that many ranks.
        method: As for ``measure``.
        result: File to write.
    """
    why = missing(method)
    found: list[dict[str, Any]] = []
    if not why:
        body = read_body(folder, comm.size, comm.rank)
        for cracked in (False, True):
            found.append({"crack": "half" if cracked else "none"})
            found[-1] |= measure(comm, body, method, cracked)
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    most = max(comm.allgather(own))
    if comm.rank == 0:
        rows = [row | {"memory_mib_per_rank": most} for row in found]
        result.write_text(json.dumps({"missing": why, "rows": rows}), encoding="utf-8")
