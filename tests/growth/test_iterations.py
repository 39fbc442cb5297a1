"""Iterations of multigrid along a crack that its aggregates fit badly."""

import pytest
from mpi4py import MPI

from pearlite_petsc.config import load_scene_text
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.solver import reuse
from pearlite_petsc.solver.equilibrium import Equilibrium
from tests.scenes import STATES

HARD = "moderate_TA", 4


def iterations_along_a_crack(monkeypatch: pytest.MonkeyPatch) -> tuple[list[int], dict[str, float]]:
    """Return the iterations of each solve of a crack, and its counters."""
    found: list[int] = []
    run = Equilibrium._solve_iterative

    def counted(self: Equilibrium) -> None:
        before = self.counters["iterations"]
        run(self)
        found.append(self.counters["iterations"] - before)

    monkeypatch.setattr(Equilibrium, "_solve_iterative", counted)
    state, index = STATES[HARD[0]], HARD[1]
    scene = load_scene_text("", "test", ["solver.method=iterative", "elements.kinds=labels"])
    prepared = prepare_growth(scene, state, index)
    outcome = CrackGrowth(MPI.COMM_SELF, scene, state, 18e3, prepared).grown()
    assert outcome is not None
    assert not {"refreshed", "direct"} & {*outcome.effort.counters}
    return found, outcome.effort.counters


def test_no_solve_on_the_way_takes_more_than_forty(monkeypatch: pytest.MonkeyPatch) -> None:
    iterations, counters = iterations_along_a_crack(monkeypatch)
    assert counters["finer"] >= 1
    assert max(iterations) <= 40


def test_supports_keep_bad_aggregates_from_moving_the_whole_body(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(reuse, "many_iterations", lambda _: 1e3)
    iterations, counters = iterations_along_a_crack(monkeypatch)
    assert "finer" not in counters
    assert max(iterations) < 80
