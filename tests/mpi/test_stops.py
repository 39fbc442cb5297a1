"""A stop is seen in the middle of what takes long, and what is finished is on disk by then."""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

from tests.mpi.launch import FAULTY, assert_same_cracks, outcomes, rows, run, start

SECONDS = 120
FINISHED = ("undeformed_m0_dk10", "undeformed_m0_dk18")


def finished(folder: Path) -> set[str]:
    return {path.stem for path in (folder / "out" / "checkpoint" / "finished").glob("*.h5")}


def wait_for(folder: Path, names: tuple[str, ...], process: subprocess.Popen[str]) -> None:
    """Wait until these cracks are finished and somebody grows the next mesh."""
    end = time.monotonic() + SECONDS
    while not finished(folder) >= set(names):
        assert time.monotonic() < end
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)
    time.sleep(0.5)


def assert_all_finished_is_in_the_tables(folder: Path) -> None:
    names = {
        f"{row['state']}_m{row['mesh']}_dk{float(row['delta_k_mpa_sqrt_m']):g}"
        for row in rows(folder)
    }
    assert names == finished(folder)
    assert len(outcomes(folder)) == len(names)


def assert_goes_on(folder: Path, reference: Path) -> None:
    done = run(1, folder, "--resume")
    assert done.returncode == 0, done.stderr
    assert_same_cracks(folder, reference)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGUSR1])
def test_a_stop_ends_a_mesh_that_would_take_for_ever(
    number: signal.Signals, reference: Path, tmp_path: Path
) -> None:
    process = start(1, tmp_path, program=(*FAULTY, "endless_mesh"))
    wait_for(tmp_path, FINISHED, process)
    process.send_signal(number)
    out, err = process.communicate(timeout=SECONDS)
    assert process.returncode == 130, err
    assert f"stopped ({number.name} received): 2 done, 0 failed, 4 missing; --resume goes on" in out
    assert_all_finished_is_in_the_tables(tmp_path)
    assert_goes_on(tmp_path, reference)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_stop_of_mpirun_finds_what_is_finished_on_disk(
    number: signal.Signals, reference: Path, tmp_path: Path
) -> None:
    """mpirun ends its ranks a second or two later and has an exit status of its own."""
    process = start(2, tmp_path, program=(*FAULTY, "endless_mesh"))
    wait_for(tmp_path, FINISHED, process)
    os.kill(process.pid, number)
    process.communicate(timeout=SECONDS)
    assert process.returncode != 0
    assert_all_finished_is_in_the_tables(tmp_path)
    assert_goes_on(tmp_path, reference)


def test_the_wall_time_is_seen_in_a_mesh_that_would_take_for_ever(tmp_path: Path) -> None:
    only = ("--set", "ensemble.meshes=1", "--max-walltime", 5)
    done = run(1, tmp_path, *only, program=(*FAULTY, "endless_mesh"))
    assert done.returncode == 130, done.stderr
    assert "stopped (wall time reached)" in done.stdout
    assert_all_finished_is_in_the_tables(tmp_path)


def test_a_stop_is_seen_in_a_figure_that_would_take_for_ever(
    reference: Path, tmp_path: Path
) -> None:
    drawing = ("--set", "output.figures=true")
    process = start(1, tmp_path, *drawing, program=(*FAULTY, "endless_figures"))
    assert process.stdout is not None
    for line in process.stdout:
        if line.startswith("drawing"):
            break
    time.sleep(0.5)
    process.send_signal(signal.SIGTERM)
    out, err = process.communicate(timeout=SECONDS)
    assert process.returncode == 130, err
    assert "stopped (SIGTERM received): 6 done, 0 failed, 0 missing; --resume goes on" in out
    assert not (tmp_path / "out" / "report.html").exists()
    assert_same_cracks(tmp_path, reference)


def test_tables_are_kept_while_cracks_still_grow(tmp_path: Path) -> None:
    process = start(1, tmp_path, program=(*FAULTY, "endless_mesh"))
    wait_for(tmp_path, FINISHED, process)
    end = time.monotonic() + SECONDS
    while len(rows(tmp_path)) < len(FINISHED) or len(outcomes(tmp_path)) < len(FINISHED):
        assert time.monotonic() < end
        time.sleep(0.1)
    process.kill()
    process.communicate(timeout=SECONDS)
    assert_all_finished_is_in_the_tables(tmp_path)
