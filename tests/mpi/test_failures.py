"""What goes wrong in one task or on one rank has a defined end."""

import subprocess
from pathlib import Path

import pytest

from tests.mpi.launch import FAULTY, assert_same_cracks, outcomes, rows, run

GOOD = {"undeformed", "moderate_TA"}


def failed_as_one(folder: Path, done: subprocess.CompletedProcess[str], error: str) -> None:
    assert done.returncode == 3, done.stderr
    assert "4 done, 2 failed, 0 missing" in done.stdout
    assert f"severe_AT_m0_dk18: {error}\n" in done.stderr
    for outcome in outcomes(folder):
        if outcome.state in GOOD:
            assert outcome.stop_reason.value == "grown"
            continue
        assert outcome.stop_reason.value == "failed"
        first, _, rest = outcome.message.partition("\n")
        assert first == error
        assert "Traceback (most recent call last)" in rest


@pytest.mark.parametrize(
    "fault, ranks, error",
    [
        ("all_ranks", 2, "SolverError: no equilibrium, says the test"),
        ("no_mesh", 1, "MeshError: no mesh, says the test"),
    ],
)
def test_a_failed_task_is_an_outcome_and_the_others_go_on(
    fault: str, ranks: int, error: str, tmp_path: Path
) -> None:
    done = run(ranks, tmp_path, "--ranks-per-task", ranks, program=(*FAULTY, fault))
    failed_as_one(tmp_path, done, error)


def test_failed_tasks_stay_until_they_are_to_be_tried_again(
    reference: Path, tmp_path: Path
) -> None:
    done = run(1, tmp_path, program=(*FAULTY, "odd_error"))
    failed_as_one(tmp_path, done, "ZeroDivisionError: an error nobody thought of")
    done = run(1, tmp_path, "--resume", program=(*FAULTY, "none"))
    assert done.returncode == 3
    assert [row["stop_reason"] for row in rows(tmp_path)].count("failed") == 2
    done = run(1, tmp_path, "--resume", "--retry-failed", program=(*FAULTY, "none"))
    assert done.returncode == 0, done.stderr
    assert "going on: 4 of 6 tasks done, 0 failed, 2 missing" in done.stdout
    assert_same_cracks(tmp_path, reference)


def test_an_error_on_one_rank_of_a_group_aborts_the_job_and_does_not_hang(tmp_path: Path) -> None:
    done = run(2, tmp_path, "--ranks-per-task", 2, program=(*FAULTY, "one_rank"))
    assert done.returncode not in (0, 2, 3, 130)
    assert "an error on one rank only" in done.stderr


def test_a_disk_that_is_full_is_said_and_the_next_run_goes_on(
    reference: Path, tmp_path: Path
) -> None:
    done = run(1, tmp_path, program=(*FAULTY, "small_files"))
    assert done.returncode == 1
    assert_one_message(done, "File too large")
    assert "--resume goes on" in done.stdout
    assert not list((tmp_path / "out").rglob("*.partial"))
    done = run(1, tmp_path, "--resume")
    assert done.returncode == 0, done.stderr
    assert "going on: " in done.stdout
    assert_same_cracks(tmp_path, reference)


def assert_one_message(done: subprocess.CompletedProcess[str], what: str) -> None:
    """Assert that one line says what cannot be written, and that no traceback is shown."""
    said = [line for line in done.stderr.splitlines() if "the output cannot be written" in line]
    assert len(said) == 1, done.stderr
    assert what in said[0]
    assert "/out/" in said[0]
    assert "Traceback" not in done.stderr + done.stdout


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_disk_that_fills_while_figures_are_drawn_is_said_once(
    ranks: int, reference: Path, tmp_path: Path
) -> None:
    figures = ("--set", "output.figures=true")
    done = run(ranks, tmp_path, *figures, program=(*FAULTY, "small_figures"))
    assert done.returncode == 1
    assert_one_message(done, "File too large")
    assert_same_cracks(tmp_path, reference)
    assert not list((tmp_path / "out").rglob("*.partial"))
    done = run(1, tmp_path, *figures, "--resume")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "report.html").is_file()


def test_a_mesh_that_cannot_be_refined_fails_its_task_on_all_ranks_of_the_group(
    tmp_path: Path,
) -> None:
    few = ("--set", "loading.delta_k_mpa_sqrt_m=[18]", "--ranks-per-task", 2)
    done = run(2, tmp_path, *few, program=(*FAULTY, "no_next_mesh"))
    assert done.returncode == 3, done.stderr
    failed = [o for o in outcomes(tmp_path) if o.stop_reason.value == "failed"]
    assert failed
    assert {o.message.partition("\n")[0] for o in failed} == {
        "MeshError: no finer mesh, says the test"
    }
