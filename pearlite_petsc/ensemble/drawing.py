"""Figures and report of a run, drawn by its ranks."""

import logging
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from mpi4py import MPI

from pearlite_petsc.config import scene_to_toml
from pearlite_petsc.ensemble.board import Board
from pearlite_petsc.ensemble.group import wait_for_all
from pearlite_petsc.ensemble.status import COLUMNS, Status
from pearlite_petsc.ensemble.stop import StoppedError, left_when
from pearlite_petsc.ensemble.trouble import tell_not_writable
from pearlite_petsc.launch.display import Screen, Standing
from pearlite_petsc.output.experiment import Experiment
from pearlite_petsc.output.results import read_results
from pearlite_petsc.scene import Scene

_log = logging.getLogger(__name__)

Job = tuple[str, Callable[[], object]]

MOST_DRAWING = 4
"""Ranks that draw figures; each reads all results."""


def draw_and_report(
    world: MPI.Comm,
    folder: Path,
    scene: Scene,
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
        experiment: Measured points to draw.
        stopping: Not 0 where this rank is to draw no more.
        screen: What the user sees.

    Returns:
        Whether everything was drawn.
    """
    jobs: list[Job] = []
    report: Callable[[], object] | None = None
    if world.rank < MOST_DRAWING:
        jobs, report = _jobs(folder, scene, experiment)
    count = world.bcast(len(jobs))
    if world.rank == 0:
        screen.line(f"drawing {count} figures")
    start = (np.zeros(count, dtype=np.int64), np.full((count, len(COLUMNS)), np.nan))
    board = Board(world, *(start if world.rank == 0 else (None, None)))
    fine = True
    for number, (name, draw) in _claimed(board, jobs, stopping):
        if world.rank == 0:
            screen.stand(Standing(f"drawing figure {number + 1} of {count}"))
        fine &= _drawn(name, draw, board, stopping, screen)
    wait_for_all(world, board.tick)
    if world.rank == 0 and report is not None and not stopping() and not board.stop_code():
        screen.stand(Standing("writing the report"))
        fine &= _drawn("report", report, board, stopping, screen)
    board.close()
    return bool(world.allreduce(fine, MPI.LAND))


def _jobs(
    folder: Path, scene: Scene, experiment: Experiment | None
) -> tuple[list[Job], Callable[[], object]]:
    """Return the figures and what writes the report."""
    # Loaded by those who draw, when they draw: it takes as long as a small run.
    from pearlite_petsc.output.draw import figure_jobs
    from pearlite_petsc.output.report.page import write_report
    from pearlite_petsc.output.result_folder import Result

    stored = read_results(folder / "results.h5")
    measured = () if experiment is None else experiment.points
    result = Result(folder, scene, stored.outcomes, measured)
    page, text = folder / "report.html", scene_to_toml(scene)
    return figure_jobs(result), lambda: write_report(page, result, text, stored.provenance)


def _drawn(
    name: str,
    draw: Callable[[], object],
    board: Board,
    stopping: Callable[[], int],
    screen: Screen,
) -> bool:
    """Draw one figure; return whether nothing was wrong with it."""
    try:
        with left_when(stopping):
            draw()
    except StoppedError:
        return True
    except OSError as error:
        tell_not_writable(board, screen, error)
        return False
    except Exception:
        _log.exception("figure %s is left out", name)
        return False
    return True


def _claimed(
    board: Board, jobs: Sequence[Job], stopping: Callable[[], int]
) -> Iterator[tuple[int, Job]]:
    for number, job in enumerate(jobs):
        if stopping() or board.stop_code():
            return
        if board.status()[number] == Status.OPEN and board.claim(number):
            yield number, job
