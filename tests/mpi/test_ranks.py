"""The number of ranks changes no result."""

from pathlib import Path

import numpy as np
import pytest

from tests.mpi.launch import assert_same_cracks, outcomes, rows, run


def test_three_ranks_grow_the_same_cracks_as_one(reference: Path, tmp_path: Path) -> None:
    done = run(3, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("] ") == len(rows(reference)) == 6
    assert_same_cracks(tmp_path, reference)


def test_two_ranks_that_share_a_task_agree_with_one_up_to_the_solver(
    reference: Path, reference_of_pairs: Path
) -> None:
    pairs = zip(outcomes(reference_of_pairs), outcomes(reference), strict=True)
    for mine, alone in pairs:
        assert mine.shape is not None
        assert alone.shape is not None
        assert len(mine.shape.broken_pairs)
        assert np.array_equal(mine.shape.broken_pairs, alone.shape.broken_pairs)
        assert mine.effort.solves == alone.effort.solves
        assert mine.cycles == pytest.approx(alone.cycles, rel=1e-6)
        assert mine.da_dn == pytest.approx(alone.da_dn, rel=1e-6)
        assert mine.tortuosity == pytest.approx(alone.tortuosity, rel=1e-9)


SHORT = ("--set", "loading.delta_k_mpa_sqrt_m=[18.0]", "--set", "loading.extension_um=8")


@pytest.fixture(scope="module")
def short_cracks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run of short cracks on one rank."""
    folder = tmp_path_factory.mktemp("short")
    done = run(1, folder, *SHORT)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.parametrize("ranks", [3, 4])
def test_more_ranks_a_task_break_the_same_interfaces(
    ranks: int, short_cracks: Path, tmp_path: Path
) -> None:
    done = run(ranks, tmp_path, "--ranks-per-task", ranks, *SHORT)
    assert done.returncode == 0, done.stderr
    shared, alone = outcomes(tmp_path), outcomes(short_cracks)
    assert len(shared) == 3
    for mine, other in zip(shared, alone, strict=True):
        assert mine.shape is not None and len(mine.shape.broken_pairs)
        assert np.array_equal(mine.shape.broken_pairs, other.shape.broken_pairs)
        assert mine.da_dn == pytest.approx(other.da_dn, rel=1e-6)


def test_two_ranks_that_share_a_crack_with_a_coarse_wake_agree_with_one(tmp_path: Path) -> None:
    coarse = (
        *("--set", "elements.wake=coarse", "--set", "elements.radius_um=10"),
        *("--set", "window.width_um=120", "--set", "loading.extension_um=45"),
        *("--set", "loading.delta_k_mpa_sqrt_m=[18.0]"),
    )
    folders = tmp_path / "one", tmp_path / "two"
    for ranks, folder in zip((1, 2), folders, strict=True):
        folder.mkdir()
        done = run(ranks, folder, "--ranks-per-task", ranks, *coarse)
        assert done.returncode == 0, done.stderr
    alone, shared = (outcomes(folder) for folder in folders)
    for mine, other in zip(shared, alone, strict=True):
        assert mine.extension > 45.0 or mine.state == "moderate_TA"
        assert np.array_equal(mine.shape.broken_pairs, other.shape.broken_pairs)
        assert mine.da_dn == pytest.approx(other.da_dn, rel=1e-6)


@pytest.mark.parametrize("ranks", [1, 2])
def test_half_cycles_are_for_one_rank_alone(ranks: int, tmp_path: Path) -> None:
    loose = ("--set", "solver.method=iterative", "--set", "solver.relative_tolerance=1e-6")
    done = run(ranks, tmp_path, "--ranks-per-task", ranks, *SHORT, *loose)
    assert done.returncode == 0, done.stderr
    assert [("upward" in crack.effort.counters) for crack in outcomes(tmp_path)] == [ranks == 1] * 3
