"""What a user sees of a run, and how it is asked to stop."""

import io
import json
import os
import signal
from pathlib import Path
from time import monotonic

import numpy as np
import pytest

from pearlite_petsc.ensemble.expected import Forecast
from pearlite_petsc.ensemble.progress import Progress, clock
from pearlite_petsc.ensemble.status import COLUMNS, REASONS, Status
from pearlite_petsc.ensemble.stop import WALL_TIME, StopRequest, describe
from pearlite_petsc.ensemble.tasks import all_tasks
from pearlite_petsc.fatigue.outcome import StopReason
from tests.scenes import default_scene

SCENE = default_scene(ensemble={"meshes": 1})
TASKS = all_tasks(SCENE)


def shown(path: Path, terminal: bool) -> str:
    """Return what a run of three looks at the board puts out."""
    stream = io.StringIO()
    progress = Progress(path, TASKS, Forecast(SCENE, TASKS), 2, terminal, stream)
    status = np.zeros(len(TASKS), dtype=np.int64)
    values = np.full((len(TASKS), len(COLUMNS)), np.nan)
    status[:2] = Status.RUNNING
    progress.show(status.copy(), values)
    status[:3] = Status.DONE, Status.FAILED, Status.RUNNING
    values[0] = 2.0, 2.5e-3, REASONS.index(StopReason.GROWN)
    values[1] = 1.0, np.nan, REASONS.index(StopReason.FAILED)
    progress.show(status.copy(), values)
    progress.show(status.copy(), values, last=True)
    return stream.getvalue()


def test_each_task_is_one_line_where_no_terminal_is(tmp_path: Path) -> None:
    lines = shown(tmp_path / "progress.json", terminal=False).splitlines()
    assert len(lines) == 2
    assert lines[0].startswith("[ 1/20] undeformed_m0_dk8: grown, 2.500e-09 m/cycle, 2.00 s")
    assert lines[1].startswith("[ 2/20] undeformed_m0_dk12: failed, no growth rate, 1.00 s")
    assert "running 1  failed 1" in lines[1]


def test_a_terminal_shows_one_bar(tmp_path: Path) -> None:
    text = shown(tmp_path / "progress.json", terminal=True)
    assert text.count("\n") == 1
    assert "2/20 done, 1 running, 1 failed" in text.split("\r")[-1]


def test_progress_can_be_watched_from_outside(tmp_path: Path) -> None:
    shown(tmp_path / "progress.json", terminal=False)
    content = json.loads((tmp_path / "progress.json").read_text())
    assert content["total"] == 20
    assert content["done"] == content["failed"] == 1
    assert content["running"] == [TASKS[2].name]
    assert content["ended"] is True


def test_a_file_that_cannot_be_written_stops_nothing(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert shown(tmp_path / "file" / "progress.json", terminal=False)


def test_a_user_who_has_gone_stops_nothing(tmp_path: Path) -> None:
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "w") as stream:
        progress = Progress(
            tmp_path / "progress.json", TASKS, Forecast(SCENE, TASKS), 1, True, stream
        )
        nothing = np.full((len(TASKS), len(COLUMNS)), np.nan)
        progress.show(np.zeros(len(TASKS), dtype=np.int64), nothing)
        assert (tmp_path / "progress.json").is_file()
        # Else closing the stream would report what it could not send off.
        os.dup2(os.open(os.devnull, os.O_WRONLY), write)


@pytest.mark.parametrize("seconds, text", [(0.4, "0:00"), (59.6, "1:00"), (3725.0, "1:02:05")])
def test_times_are_read_as_clocks(seconds: float, text: str) -> None:
    assert clock(seconds) == text


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGUSR1])
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
