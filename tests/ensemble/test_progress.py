"""What a run tells of itself, and how it is asked to stop."""

import json
import os
import signal
from pathlib import Path
from time import monotonic

import numpy as np
import pytest

from pearlite_petsc.ensemble.expected import Forecast
from pearlite_petsc.ensemble.progress import Progress
from pearlite_petsc.ensemble.status import COLUMNS, REASONS, Status
from pearlite_petsc.ensemble.stop import WALL_TIME, StopRequest, describe
from pearlite_petsc.ensemble.tasks import all_tasks
from pearlite_petsc.fatigue.outcome import StopReason
from pearlite_petsc.launch.display import Standing
from tests.scenes import default_scene

SCENE = default_scene(ensemble={"meshes": 1})
TASKS = all_tasks(SCENE)


class Seen:
    """A screen that remembers."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.standings: list[Standing] = []

    def line(self, text: str) -> None:
        self.lines.append(text)

    def trouble(self, text: str) -> None:
        raise AssertionError(text)

    def stand(self, standing: Standing) -> None:
        self.standings.append(standing)

    def stopping(self, signal_name: str) -> None:
        raise AssertionError(signal_name)


def shown(path: Path) -> Seen:
    """Return what a run of three looks at the board shows."""
    seen = Seen()
    progress = Progress(path, TASKS, Forecast(SCENE, TASKS), 2, seen)
    status = np.zeros(len(TASKS), dtype=np.int64)
    values = np.full((len(TASKS), len(COLUMNS)), np.nan)
    status[:2] = Status.RUNNING
    progress.show(status.copy(), values)
    status[:3] = Status.DONE, Status.FAILED, Status.RUNNING
    values[0] = 2.0, 2.5e-3, REASONS.index(StopReason.GROWN)
    values[1] = 1.0, np.nan, REASONS.index(StopReason.FAILED)
    progress.show(status.copy(), values)
    progress.show(status.copy(), values, last=True)
    return seen


def test_each_task_is_one_line_with_its_rate_and_why_it_ended(tmp_path: Path) -> None:
    lines = shown(tmp_path / "progress.json").lines
    assert len(lines) == 2
    assert lines[0].startswith("[ 1/20] undeformed_m0_dk8: grown, 2.500e-09 m/cycle, 2.00 s")
    assert lines[1].startswith("[ 2/20] undeformed_m0_dk12: failed, no growth rate, 1.00 s")
    assert "running 1  failed 1" in lines[1]


def test_the_screen_knows_where_the_run_stands(tmp_path: Path) -> None:
    first, second = shown(tmp_path / "progress.json").standings
    assert (first.done, first.running, first.failed, first.total) == (0, 2, 0, 20)
    assert (second.done, second.running, second.failed, second.total) == (2, 1, 1, 20)
    assert first.left_s > 0.0


def test_progress_can_be_watched_from_outside(tmp_path: Path) -> None:
    shown(tmp_path / "progress.json")
    content = json.loads((tmp_path / "progress.json").read_text())
    assert content["total"] == 20
    assert content["done"] == content["failed"] == 1
    assert content["running"] == [TASKS[2].name]
    assert content["ended"] is True


def test_a_file_that_cannot_be_written_stops_nothing(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert shown(tmp_path / "file" / "progress.json").lines


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGHUP])
def test_a_signal_is_remembered_and_the_old_handler_comes_back(number: signal.Signals) -> None:
    before = signal.getsignal(number)
    with StopRequest(None, monotonic()) as request:
        assert request.code() == 0
        os.kill(os.getpid(), number)
        assert request.code() == number
        assert describe(request.code()) == f"{number.name} received"
    assert signal.getsignal(number) == before


def test_the_wall_time_is_a_request_once_it_is_over() -> None:
    with StopRequest(1e6, monotonic()) as request:
        assert request.code() == 0
    with StopRequest(5.0, monotonic() - 6.0) as request:
        assert request.code() == WALL_TIME
        os.kill(os.getpid(), signal.SIGUSR1)
        assert request.code() == signal.SIGUSR1
