"""The ensemble as a whole: groups, board, workers, and what is there when they are done."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

import numpy as np
from mpi4py import MPI

from pearlite_petsc.config import scene_hash
from pearlite_petsc.ensemble.board import Board
from pearlite_petsc.ensemble.crack import Ground
from pearlite_petsc.ensemble.expected import Forecast
from pearlite_petsc.ensemble.group import Group, wait_for_all
from pearlite_petsc.ensemble.lookout import Lookout
from pearlite_petsc.ensemble.products import Products
from pearlite_petsc.ensemble.progress import Progress
from pearlite_petsc.ensemble.status import COLUMNS, Status, status_of, values_of
from pearlite_petsc.ensemble.stop import StopRequest
from pearlite_petsc.ensemble.store import Store
from pearlite_petsc.ensemble.tasks import Task, all_tasks
from pearlite_petsc.ensemble.worker import Worker
from pearlite_petsc.launch.display import Screen
from pearlite_petsc.scene import Scene

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Found:
    """What a run finds of earlier ones: status and values of each task, cracks on their way."""

    status: list[int]
    values: list[list[float]]
    growing: int


def look_back(folder: Path, scene: Scene, retry_failed: bool) -> Found:
    """Return what earlier runs left in the folder. First rank only.

    Args:
        folder: The output folder.
        scene: The scene.
        retry_failed: Whether failed tasks are forgotten.

    Raises:
        SceneError: A file there belongs to another scene.
    """
    tasks = all_tasks(scene)
    store = Store(folder / "checkpoint", scene_hash(scene))
    status, values = [], []
    for task in tasks:
        kept = store.read_finished(task)
        if kept is not None and retry_failed and status_of(kept[0]) is Status.FAILED:
            store.forget_finished(task)
            kept = None
        if kept is not None:
            # Left where a run was killed between keeping the outcome and dropping these.
            store.forget_growing(task)
        status.append(int(Status.OPEN if kept is None else status_of(kept[0])))
        values.append([np.nan] * len(COLUMNS) if kept is None else values_of(kept[0]).tolist())
    unfinished = [task for task in tasks if status[task.number] == Status.OPEN]
    return Found(status, values, len(store.check(unfinished)))


class Campaign:
    """Grows all cracks of a scene that are not finished. Collective over the world.

    Args:
        world: All ranks.
        scene: The scene.
        folder: The output folder, there and held by the first rank.
        found: What ``look_back`` found, on the first rank.
        interval: Seconds between checkpoints of a crack.
        request: Signals and wall time of this rank.
        screen: What the user sees.
        products: What is kept up to date beside the checkpoints, on the first rank.

    Attributes:
        seconds: Time that ``run`` took [s].
        busy_share: Mean share of it in which a rank did not wait for the last ones.
    """

    def __init__(
        self,
        world: MPI.Comm,
        scene: Scene,
        folder: Path,
        found: Found | None,
        interval: float,
        request: StopRequest,
        screen: Screen,
        products: Products | None,
    ) -> None:
        self._world, self._scene, self._folder = world, scene, folder
        self._interval, self._screen = interval, screen
        self._tasks: Sequence[Task] = all_tasks(scene)
        self._forecast = Forecast(scene, self._tasks)
        status = values = None
        if found is not None:
            status = np.array(found.status, dtype=np.int64)
            values = np.array(found.values, dtype=np.float64)
        self._group = Group(world, scene.ensemble.ranks_per_task)
        self._board = Board(world, status, values)
        self.seconds = self.busy_share = 0.0
        progress = None
        if world.rank == 0:
            path, groups = folder / "progress.json", self._group.count
            progress = Progress(path, self._tasks, self._forecast, groups, screen)
        self._lookout = Lookout(self._board, request, screen, progress, products)

    def run(self) -> tuple[int, int, int]:
        """Return how many tasks are done, failed and open on all ranks together. Collective."""
        began = monotonic()
        if self._group.has_ranks:
            store = Store(self._folder / "checkpoint", scene_hash(self._scene))
            ground = Ground(
                self._group,
                self._scene,
                self._folder,
                store,
                self._interval,
                self._lookout.between_steps,
            )
            Worker(ground, self._tasks, self._board, self._forecast, self._screen).work()
        worked = monotonic() - began
        wait_for_all(self._world, self._lookout.between_steps)
        self.seconds = monotonic() - began
        self.busy_share = self._world.allreduce(worked) / (self._world.size * self.seconds)
        status = self._board.status()
        self._lookout.show_the_end()
        counts = [int((status == which).sum()) for which in (Status.DONE, Status.FAILED)]
        return counts[0], counts[1], len(status) - sum(counts)

    def stop_code(self) -> int:
        """Return why the campaign stopped before its end, 0 if it did not."""
        return self._board.stop_code()

    def close(self) -> None:
        """Free board and communicators. Collective."""
        self._board.close()
        self._group.close()
