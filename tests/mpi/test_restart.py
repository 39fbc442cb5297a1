"""Whatever stops a run, the next one goes on and ends where an undisturbed one does."""

import json
import os
import random
import signal
import subprocess
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.mpi.launch import SECONDS, assert_same_cracks, copy_scene, rows, run, start

OFTEN = ("--checkpoint-interval", 0.02)


def children(parent: int) -> list[int]:
    """Return the processes that a process started, and theirs."""
    try:
        text = Path(f"/proc/{parent}/task/{parent}/children").read_text()
    except OSError:
        return []
    own = [int(word) for word in text.split()]
    return own + [inner for child in own for inner in children(child)]


def killed_after(process: subprocess.Popen[str], seconds: float, choice: random.Random) -> None:
    """Kill the job, one of its ranks, or all at once; wait until it is gone."""
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        started = [process.pid, *children(process.pid)]
        for victim in choice.choice([started, started[:1], started[-1:]]):
            try:
                os.kill(victim, signal.SIGKILL)
            except ProcessLookupError:
                continue
    process.communicate(timeout=SECONDS)


def wait_until(folder: Path, pattern: str) -> None:
    """Wait until the run has written a file of this pattern."""
    end = time.monotonic() + SECONDS
    while not list((folder / "out").glob(pattern)):
        assert time.monotonic() < end
        time.sleep(0.005)


def assert_ends_like(folder: Path, reference: Path, ranks: int) -> None:
    done = run(ranks, folder, "--resume")
    assert done.returncode == 0, done.stderr
    assert_same_cracks(folder, reference)
    assert_same_fields(folder, reference)
    assert not list((folder / "out").rglob("*.partial"))
    assert not list((folder / "out" / "checkpoint" / "growing").glob("*"))


def assert_same_fields(folder: Path, reference: Path) -> None:
    """Assert that the ParaView files are the same, and hold no mesh twice."""
    names = sorted(path.name for path in (reference / "out" / "fields").glob("*.xdmf"))
    assert names
    for name in names:
        places = [where / "out" / "fields" / name for where in (folder, reference)]
        assert places[0].read_text() == places[1].read_text()
        mine, theirs = (h5py.File(place.with_suffix(".h5")) for place in places)
        with mine, theirs:
            assert theirs["step_0"].attrs["cycles"] == 0.0
            found: list[str] = []
            theirs.visit(found.append)
            for item in (theirs[name] for name in found):
                if isinstance(item, h5py.Dataset):
                    assert np.array_equal(item[()], mine[item.name][()], equal_nan=True)


def test_three_kills_lose_nothing(reference: Path, tmp_path: Path) -> None:
    choice = random.Random(3)
    for attempt in range(3):
        process = start(2 - attempt % 2, tmp_path, "--resume", *OFTEN)
        if attempt == 0:
            wait_until(tmp_path, "checkpoint/growing/*/*.h5")
        killed_after(process, choice.uniform(0.0, 0.6) if attempt == 0 else 2.5, choice)
    kept = {path.stem: path.stat().st_mtime_ns for path in finished(tmp_path)}
    assert_ends_like(tmp_path, reference, ranks=1)
    for path in finished(tmp_path):
        assert kept.get(path.stem, path.stat().st_mtime_ns) == path.stat().st_mtime_ns


def finished(folder: Path) -> list[Path]:
    return sorted((folder / "out" / "checkpoint" / "finished").glob("*.h5"))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_a_kill_at_any_moment_of_the_quickstart_loses_nothing(
    seed: int, reference_of_quickstart: Path, tmp_path: Path
) -> None:
    choice = random.Random(seed)
    copy_scene(reference_of_quickstart, tmp_path)
    killed_after(start(2, tmp_path, *OFTEN), choice.uniform(1.0, 40.0), choice)
    assert_ends_like(tmp_path, reference_of_quickstart, choice.choice([1, 2, 3]))


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGUSR1, signal.SIGINT])
def test_a_signal_to_one_rank_stops_all_cleanly_and_the_run_goes_on(
    number: signal.Signals, reference: Path, tmp_path: Path
) -> None:
    ranks = 2 if number == signal.SIGTERM else 1
    process = start(ranks, tmp_path, *OFTEN)
    wait_until(tmp_path, "checkpoint/growing/*/*.h5")
    os.kill(process.pid if ranks == 1 else children(process.pid)[-1], number)
    out, err = process.communicate(timeout=SECONDS)
    assert process.returncode == 130, err
    assert f"{number.name} received" in out
    written = len(rows(tmp_path))
    progress = json.loads((tmp_path / "out" / "progress.json").read_text())
    assert progress["done"] == written < progress["total"] == 6
    assert progress["ended"]
    assert progress["running"] == []
    assert list((tmp_path / "out" / "checkpoint" / "growing").glob("*/[ab].h5"))
    assert not (tmp_path / "out" / "report.html").exists()
    if number != signal.SIGINT:
        assert_ends_like(tmp_path, reference, 1)


def test_the_wall_time_stops_the_run_before_its_end(tmp_path: Path) -> None:
    done = run(1, tmp_path, "--max-walltime", 0)
    assert done.returncode == 130, done.stderr
    assert "wall time reached" in done.stdout
    assert rows(tmp_path) == []


def test_a_group_of_two_ranks_goes_on_bit_for_bit(reference_of_pairs: Path, tmp_path: Path) -> None:
    pair = ("--ranks-per-task", 2)
    process = start(2, tmp_path, *pair, *OFTEN)
    wait_until(tmp_path, "checkpoint/growing/moderate_TA*/b.h5")
    os.kill(children(process.pid)[-1], signal.SIGUSR1)
    process.communicate(timeout=SECONDS)
    assert process.returncode == 130
    assert run(2, tmp_path, *pair, "--resume").returncode == 0
    assert_same_cracks(tmp_path, reference_of_pairs)


def test_a_damaged_checkpoint_gives_way_to_the_one_before(reference: Path, tmp_path: Path) -> None:
    process = start(1, tmp_path, *OFTEN)
    wait_until(tmp_path, "checkpoint/growing/moderate_TA*/b.h5")
    process.send_signal(signal.SIGUSR1)
    process.communicate(timeout=SECONDS)
    folder = next((tmp_path / "out" / "checkpoint" / "growing").glob("moderate_TA*"))
    newest = max(folder.glob("[ab].h5"), key=lambda path: path.stat().st_mtime_ns)
    newest.write_bytes(newest.read_bytes()[:-100])
    assert_ends_like(tmp_path, reference, ranks=1)
    log = (tmp_path / "out" / "run.log").read_text()
    assert f"{newest}: is truncated" in log
    assert "an older checkpoint is used" in log
    whole = tmp_path / "out" / "results.h5"
    with h5py.File(whole) as file:
        assert len(file["tasks"]) == 6
