"""What a solver that fails falls back on: newer factors, multigrid, a direct solver, an error."""

import numpy as np
import pytest

from pearlite_petsc.errors import SolverError
from pearlite_petsc.mechanics import statics
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.scene import Kind
from tests.solver.bodies import (
    NOTCHED,
    PULL,
    STEEL,
    equilibrium_of,
    forces,
    none_broken,
    options,
    tractions,
)


def test_old_factors_that_no_longer_converge_are_refreshed_and_counted() -> None:
    broken = NOTCHED.kind == Kind.NOTCH
    with (
        options(pearlite_ksp_max_it="2"),
        equilibrium_of(NOTCHED, broken, method="factors") as equilibrium,
    ):
        load = forces(NOTCHED, equilibrium)
        equilibrium.solve(load)
        assert not {"refreshed", "direct"} & {*equilibrium.counters}
        ahead = np.hypot(*(NOTCHED.midpoint - NOTCHED.notch).T) < 6.0
        damage = np.where(ahead, 0.9, broken)
        equilibrium.update(damage)
        equilibrium.solve(load)
        assert equilibrium.counters["refreshed"] == 1
        assert "direct" not in equilibrium.counters


def test_multigrid_that_does_not_converge_is_refreshed_then_replaced_by_a_direct_solver() -> None:
    broken = NOTCHED.kind == Kind.NOTCH
    exact = statics.solve(NOTCHED, spring_stiffness(NOTCHED, STEEL), broken, PULL)
    with options(pearlite_ksp_max_it="1"), equilibrium_of(NOTCHED, none_broken(NOTCHED)) as solver:
        load = forces(NOTCHED, solver)
        solver.update(broken.astype(float))
        found = tractions(solver, load)
        assert (solver.counters["refreshed"], solver.counters["direct"]) == (1, 1)
        solver.solve(-load)
        assert (solver.counters["refreshed"], solver.counters["direct"]) == (1, 2)
    error = np.abs(found - exact.traction)[~broken].max()
    assert error < 1e-6 * np.abs(exact.traction).max()


def test_factors_that_cannot_be_made_are_replaced_by_multigrid_and_counted() -> None:
    broken = NOTCHED.kind == Kind.NOTCH
    with (
        options(pearlite_pc_factor_mat_solver_type="absent"),
        equilibrium_of(NOTCHED, broken, method="factors") as equilibrium,
    ):
        assert equilibrium.counters["multigrid"] == 1
        equilibrium.solve(forces(NOTCHED, equilibrium))
        assert "direct" not in equilibrium.counters


def test_when_the_direct_solver_fails_too_the_error_names_residual_and_limit() -> None:
    useless = {"pearlite_ksp_max_it": "1", "pearlite_direct_pc_type": "none"}
    with options(**useless), equilibrium_of(NOTCHED, NOTCHED.kind == Kind.NOTCH) as equilibrium:
        with pytest.raises(
            SolverError, match=r"direct solver: .*relative residual .* against 1e-06"
        ):
            equilibrium.solve(forces(NOTCHED, equilibrium))
        assert equilibrium.counters["direct"] == 1
