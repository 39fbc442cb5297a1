"""A group at work: which cracks it takes, what it keeps of them, and what it gives back."""

from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("petsc4py")
from mpi4py import MPI

from pearlite_petsc.config import scene_hash
from pearlite_petsc.ensemble import worker as worker_module
from pearlite_petsc.ensemble.board import Board
from pearlite_petsc.ensemble.crack import Ground, NotWritableError
from pearlite_petsc.ensemble.expected import Forecast
from pearlite_petsc.ensemble.group import Group
from pearlite_petsc.ensemble.status import COLUMNS, Status
from pearlite_petsc.ensemble.stop import NOT_WRITABLE, StoppedError
from pearlite_petsc.ensemble.store import Store
from pearlite_petsc.ensemble.tasks import Task, all_tasks
from pearlite_petsc.ensemble.worker import Worker
from pearlite_petsc.errors import MeshError
from pearlite_petsc.fatigue.outcome import CrackShape, Effort, Outcome, StopReason
from pearlite_petsc.scene import Scene, State
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    states=(STATES["undeformed"], STATES["severe_AT"]),
    ensemble={"meshes": 2},
    loading={"delta_k": (12e3, 18e3)},
)
TASKS = all_tasks(SCENE)


class Silence:
    """A screen that keeps what is said of troubles."""

    def __init__(self) -> None:
        self.troubles: list[str] = []

    def trouble(self, text: str) -> None:
        self.troubles.append(text)


class Work:
    """A worker whose meshes and cracks are stand-ins, and what it did.

    Attributes:
        made: How often each mesh was made.
        grown: Names of the tasks, in the order in which they were grown.
        faults: What making a mesh (state and index) or growing a task (name) raises.
    """

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.made: Counter[tuple[str, int]] = Counter()
        self.grown: list[str] = []
        self.faults: dict[Any, Exception] = {}
        self.screen, self.folder = Silence(), folder
        (folder / "growth").mkdir()
        (folder / "checkpoint").mkdir()
        self.group = Group(MPI.COMM_SELF, 1)
        empty = np.full((len(TASKS), len(COLUMNS)), np.nan)
        self.board = Board(MPI.COMM_SELF, np.zeros(len(TASKS), dtype=np.int64), empty)
        self.store = Store(folder / "checkpoint", scene_hash(SCENE))
        monkeypatch.setattr(worker_module, "prepare_growth", self._prepare)
        monkeypatch.setattr(worker_module, "mesh_hash", lambda mesh: "hash")
        monkeypatch.setattr(worker_module, "grow_task", self._grow)

    def run(self, stopping: Callable[[], bool] | None = None) -> list[Status]:
        """Let the worker work; return the status of each task."""
        stop = stopping or (lambda: bool(self.board.stop_code()))
        ground = Ground(self.group, SCENE, self.folder, self.store, 60.0, stop)
        forecast = Forecast(SCENE, TASKS)
        Worker(ground, TASKS, self.board, forecast, self.screen).work()  # type: ignore[arg-type]
        return [Status(value) for value in self.board.status()]

    def _prepare(self, scene: Scene, state: State, index: int) -> Any:
        self.made[state.name, index] += 1
        if (state.name, index) in self.faults:
            raise self.faults[state.name, index]
        return type("Prepared", (), {"mesh": None})

    def _grow(self, ground: Ground, task: Task, *_: object) -> Outcome:
        if task.name in self.faults:
            raise self.faults[task.name]
        self.grown.append(task.name)
        history = np.array([[0.0, 80.0, 0.0, 0.0], [1e4, 81.0, 1.0, 1.0]])
        path = np.array([[80.0, 100.0], [81.0, 100.0]])
        return Outcome(
            task.state.name,
            task.mesh_index,
            task.delta_k,
            StopReason.GROWN,
            cycles=1e4,
            extension=1.0,
            da_dn=1e-4,
            history=history,
            effort=Effort(wall_s=0.5),
            shape=CrackShape(path, np.array([[1, 2]])),
        )

    def close(self) -> None:
        self.board.close()
        self.group.close()


@pytest.fixture
def work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Work]:
    made = Work(tmp_path, monkeypatch)
    yield made
    made.close()


def test_every_crack_is_grown_once_and_every_mesh_made_once_and_all_is_kept(work: Work) -> None:
    assert work.run() == [Status.DONE] * len(TASKS)
    assert sorted(work.grown) == sorted(task.name for task in TASKS)
    assert set(work.made.values()) == {1}
    for task in TASKS:
        assert (work.folder / "growth" / f"{task.name}.csv").is_file()
        kept = work.store.read_finished(task)
        assert kept is not None
        assert (kept[0].da_dn, kept[1]) == (1e-4, "hash")
    assert work.board.values()[:, 0].tolist() == [0.5] * len(TASKS)


def test_a_mesh_that_cannot_be_made_fails_its_own_cracks_and_is_tried_once(work: Work) -> None:
    work.faults["severe_AT", 1] = MeshError("no mesh")
    found = dict(zip(TASKS, work.run(), strict=True))
    for task, status in found.items():
        is_its = (task.state.name, task.mesh_index) == ("severe_AT", 1)
        assert status is (Status.FAILED if is_its else Status.DONE)
        kept = work.store.read_finished(task)
        assert kept is not None
        assert ("no mesh" in kept[0].message) == is_its
    assert work.made["severe_AT", 1] == 1


def test_a_crack_that_is_left_in_the_middle_of_its_mesh_is_open_again(work: Work) -> None:
    work.faults |= {(task.state.name, task.mesh_index): StoppedError() for task in TASKS}
    asked: list[None] = []

    def stopping() -> bool:
        asked.append(None)
        return len(asked) > 1

    assert work.run(stopping) == [Status.OPEN] * len(TASKS)
    assert work.grown == []
    assert work.store.read_finished(TASKS[0]) is None


def test_output_that_cannot_be_written_stops_all_and_gives_the_crack_back(work: Work) -> None:
    names = [task.name for task in TASKS]
    work.faults |= {name: NotWritableError("growth/a.csv: No space left") for name in names}
    assert work.run() == [Status.OPEN] * len(TASKS)
    assert work.board.stop_code() == NOT_WRITABLE
    assert work.screen.troubles == ["the output cannot be written: growth/a.csv: No space left"]
