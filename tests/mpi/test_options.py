"""Options of PETSc that nothing uses are an error with their names."""

from pathlib import Path

import pytest

from tests.mpi.launch import run

ONE = ("--set", "loading.delta_k_mpa_sqrt_m=[18]", "--set", "loading.extension_um=5")


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_misspelt_option_is_an_error_with_the_nearest_known_one(
    ranks: int, tmp_path: Path
) -> None:
    done = run(ranks, tmp_path, *ONE, "--", "-ksp_typ", "cg", "-ksp_rtol", "1e-8", "-frobnicate")
    assert done.returncode == 1
    said = "PETSc options that nothing used: -frobnicate, -ksp_typ (did you mean -ksp_type?); "
    assert said in done.stderr
    assert "3 done, 0 failed, 0 missing" in done.stdout


def test_options_that_are_used_are_none(tmp_path: Path) -> None:
    view, log = tmp_path / "view.txt", tmp_path / "log.txt"
    used = ("-ksp_type", "cg", "-pc_type", "jacobi", "-ksp_max_it", "5000", "-ksp_view", f":{view}")
    late = ("-log_view", f":{log}", "-options_left", "0", "-pearlite_direct_pc_type", "cholesky")
    done = run(1, tmp_path, *ONE, "--", *used, *late)
    assert done.returncode == 0, done.stderr
    assert "nothing used" not in done.stderr
    # All cracks are there: nothing is solved, and nothing can be said of any option.
    done = run(1, tmp_path, *ONE, "--resume", "--", "-ksp_typ", "cg")
    assert done.returncode == 0, done.stderr
