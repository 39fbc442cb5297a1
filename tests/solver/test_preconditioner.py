"""Preconditioners of a growing damage: kept, made finer, restored, and the user's to choose."""

import numpy as np
import pytest

from pearlite_petsc.mechanics.springs import RAJE
from pearlite_petsc.scene import Kind, Material
from pearlite_petsc.solver import equilibrium as equilibrium_module
from tests.solver.bodies import NOTCHED, RANDOM, equilibrium_of, forces, none_broken, options


def test_many_iterations_let_the_hierarchies_that_follow_coarsen_less_also_when_restored() -> None:
    material = Material(206e3, 0.333, RAJE)
    broken = none_broken(RANDOM)
    with equilibrium_of(RANDOM, broken, material, tolerance=1e-9) as equilibrium:
        load = forces(RANDOM, equilibrium)
        iterations = []
        for times in (1.0, -1.0):
            before, early = equilibrium.counters["iterations"], equilibrium.state()
            found = equilibrium.solve(times * load)
            iterations.append(equilibrium.counters["iterations"] - before)
        assert equilibrium.counters["finer"] == 1
        assert equilibrium.counters["setups"] == 2
        assert iterations[1] < 0.9 * iterations[0]
        memory = equilibrium.state()
        wanted = equilibrium.solve(1.1 * load)
        assert equilibrium.counters["setups"] == 2
    for remembered, times, solution in ((memory, 1.1, wanted), (early, -1.0, found)):
        with equilibrium_of(RANDOM, broken, material, tolerance=1e-9) as again:
            again.restore(remembered)
            assert np.array_equal(again.solve(times * load), solution)


def test_who_chooses_the_aggregates_or_no_multigrid_keeps_them() -> None:
    material = Material(206e3, 0.333, RAJE)
    for given in ({"pc_gamg_square_graph": "1"}, {"pearlite_pc_type": "jacobi"}):
        with (
            options(**given),
            equilibrium_of(RANDOM, none_broken(RANDOM), material, tolerance=1e-6) as equilibrium,
        ):
            load = forces(RANDOM, equilibrium)
            equilibrium.solve(load)
            assert equilibrium.counters["iterations"] > 30
            equilibrium.solve(-load)
            assert equilibrium.counters["finer"] == 0


def test_an_old_hierarchy_whose_finest_smoother_sees_the_breaks_goes_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(equilibrium_module, "setup_cost", lambda _: 1e9)
    damage = (NOTCHED.kind == Kind.NOTCH).astype(float)
    ahead = NOTCHED.midpoint - NOTCHED.notch
    level = (ahead[:, 0] > 0.0) & (np.abs(NOTCHED.normal[:, 1]) > 0.7) & (damage < 1.0)
    order = np.argsort(np.where(level, ahead[:, 0] + 4.0 * np.abs(ahead[:, 1]), np.inf))
    with (
        options(pearlite_pc_mg_type="multiplicative"),
        equilibrium_of(NOTCHED, damage == 1.0, tolerance=1e-6) as equilibrium,
    ):
        load = forces(NOTCHED, equilibrium)
        equilibrium.solve(load)
        before = equilibrium.counters["iterations"]
        for interface in order[:8]:
            damage = damage.copy()
            damage[interface] = 1.0
            equilibrium.update(damage)
            equilibrium.solve(load)
        assert equilibrium.counters["setups"] == 1
        assert not {"refreshed", "direct"} & {*equilibrium.counters}
        # From the last solution, and yet not less than from zero: a smoother that does not see the
        # breaks needs a quarter more.
        assert equilibrium.counters["iterations"] - before <= 8 * before
