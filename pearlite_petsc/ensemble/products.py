"""What a run leaves beside its checkpoints: tables, ``results.h5``, provenance, figures, report."""

import json
import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from pearlite_petsc.config import scene_hash, scene_to_toml
from pearlite_petsc.ensemble.board import Board
from pearlite_petsc.ensemble.group import wait_for_all
from pearlite_petsc.ensemble.status import COLUMNS, Status
from pearlite_petsc.ensemble.store import Store
from pearlite_petsc.ensemble.tasks import all_tasks
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.launch.display import Screen, Standing
from pearlite_petsc.output.experiment import Experiment
from pearlite_petsc.output.provenance import write_provenance
from pearlite_petsc.output.result_folder import Result
from pearlite_petsc.output.results import read_results, write_results
from pearlite_petsc.output.tables import write_da_dn, write_fcg, write_growth
from pearlite_petsc.scene import Scene

_log = logging.getLogger(__name__)

Job = tuple[str, Callable[[], object]]

MOST_DRAWING = 4
"""Ranks that draw figures; each reads all results."""


def write_products(
    folder: Path,
    scene: Scene,
    provenance: Mapping[str, Any],
    experiment: Experiment | None = None,
) -> list[Outcome]:
    """Write the tables, ``results.h5`` and ``provenance.json`` of all finished tasks.

    First rank only.

    Args:
        folder: The output folder.
        scene: The scene.
        provenance: What ran, where and when; the hash of every mesh is added.
        experiment: Measured points to keep with the results.

    Returns:
        The finished tasks in order.
    """
    store = Store(folder / "checkpoint", scene_hash(scene))
    outcomes, hashes = [], {}
    for task in all_tasks(scene):
        kept = store.read_finished(task)
        if kept is None:
            continue
        outcomes.append(kept[0])
        hashes[f"{task.state.name}_m{task.mesh_index}"] = kept[1]
        if not (folder / "growth" / f"{task.name}.csv").exists():
            write_growth(folder / "growth", kept[0])
    facts = {
        **provenance,
        "sessions": _sessions(folder / "provenance.json", provenance, len(outcomes)),
        "scene_hash": scene_hash(scene),
        "mesh_hashes": hashes,
    }
    names = [state.name for state in scene.states]
    write_fcg(folder / "fcg.csv", outcomes, names)
    write_da_dn(folder / "da_dn.csv", outcomes, names)
    points = None if experiment is None else experiment.text
    write_results(folder / "results.h5", scene_to_toml(scene), outcomes, facts, points)
    write_provenance(folder / "provenance.json", facts)
    return outcomes


def draw_and_report(
    world: MPI.Comm,
    folder: Path,
    scene: Scene,
    provenance: Mapping[str, Any],
    experiment: Experiment | None,
    stopping: Callable[[], int],
    screen: Screen,
) -> bool:
    """Draw the figures, shared out among the ranks, and write ``report.html``.

    Collective over the world; ``results.h5`` must be there.

    Args:
        world: All ranks.
        folder: The output folder.
        scene: The scene.
        provenance: What ran, where and when.
        experiment: Measured points to draw.
        stopping: Not 0 where this rank is to draw no more.
        screen: What the user sees.

    Returns:
        Whether everything was drawn.
    """
    # Loaded by those who draw, when they draw: it takes as long as a small run.
    from pearlite_petsc.output.draw import figure_jobs
    from pearlite_petsc.output.report.page import write_report

    result: Result | None = None
    jobs: list[Job] = []
    if world.rank < MOST_DRAWING:
        outcomes = read_results(folder / "results.h5").outcomes
        measured = () if experiment is None else experiment.points
        result = Result(folder, scene, outcomes, measured)
        jobs = figure_jobs(result)
    count = world.bcast(len(jobs))
    if world.rank == 0:
        screen.line(f"drawing {count} figures")
    start = (np.zeros(count, dtype=np.int64), np.full((count, len(COLUMNS)), np.nan))
    board = Board(world, *(start if world.rank == 0 else (None, None)))
    fine = True
    for number, (name, draw) in _claimed(board, jobs):
        if stopping():
            break
        if world.rank == 0:
            screen.stand(Standing(f"drawing figure {number + 1} of {count}"))
        try:
            draw()
        except Exception:
            _log.exception("figure %s is left out", name)
            fine = False
    wait_for_all(world, board.tick)
    board.close()
    if world.rank == 0 and result is not None:
        screen.stand(Standing("writing the report"))
        write_report(folder / "report.html", result, scene_to_toml(scene), provenance)
    return bool(world.allreduce(fine, MPI.LAND))


def _sessions(path: Path, provenance: Mapping[str, Any], finished: int) -> list[dict[str, Any]]:
    """Return the runs that worked in this folder, this one last."""
    try:
        earlier = list(json.loads(path.read_text(encoding="utf-8"))["sessions"])
    except (OSError, ValueError, KeyError, TypeError):
        earlier = []
    names = ("command", "started", "ended", "ranks")
    this = {name: provenance.get(name) for name in names} | {"finished_tasks": finished}
    return [*earlier, this]


def _claimed(board: Board, jobs: Sequence[Job]) -> Iterator[tuple[int, Job]]:
    for number, job in enumerate(jobs):
        if board.status()[number] == Status.OPEN and board.claim(number):
            yield number, job
