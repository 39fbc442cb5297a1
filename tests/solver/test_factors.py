"""Factors of one damage solve while the matrix moves on, one load or many at a time."""

import numpy as np
import pytest

from pearlite_petsc.scene import Kind
from pearlite_petsc.solver.equilibrium import Equilibrium
from tests.solver.bodies import NOTCHED, equilibrium_of, forces

NOTCH = np.asarray(NOTCHED.kind == Kind.NOTCH)


def softened() -> np.ndarray:
    damage = NOTCH.astype(float)
    damage[np.hypot(*(NOTCHED.midpoint - NOTCHED.notch).T) < 6.0] = 0.9
    return damage


def solved(equilibrium: Equilibrium) -> np.ndarray:
    load = equilibrium.system.subdomain.right_hand_side(forces(NOTCHED, equilibrium))
    return equilibrium.factors(NOTCH.astype(float)).solve(load)


@pytest.mark.parametrize("method", ["iterative", "factors"])
def test_they_solve_for_their_damage_and_leave_the_system_at_its_own(method: str) -> None:
    with equilibrium_of(NOTCHED, NOTCH, method=method) as equilibrium:
        exact = equilibrium.solve(forces(NOTCHED, equilibrium))
        equilibrium.update(softened())
        found = solved(equilibrium)
        assert equilibrium.system.has_damage(softened())
        softer = equilibrium.solve(forces(NOTCHED, equilibrium))
    largest = np.abs(exact).max()
    assert np.abs(found - exact).max() < 1e-7 * largest
    assert np.abs(softer - exact).max() > 1e-3 * largest


@pytest.mark.parametrize("method", ["iterative", "factors"])
def test_many_loads_at_once_are_solved_as_one_by_one(method: str) -> None:
    rng = np.random.default_rng(6)
    rows = np.stack([rng.choice(3 * NOTCHED.element_count, 6, replace=False) for _ in range(2)])
    values = rng.normal(size=(2, 3, 6))
    with equilibrium_of(NOTCHED, NOTCH, method=method) as equilibrium:
        factors = equilibrium.factors(NOTCH.astype(float))
        found = factors.solve_triples(np.array([1, 0]), rows, values, 2)
        for triple, component in np.ndindex(2, 3):
            given = 1 - triple
            load = np.zeros(3 * NOTCHED.element_count)
            load[rows[given]] = values[given, component]
            one = factors.solve(load)
            error = np.abs(found[:, :, 3 * triple + component] - one).max()
            assert error < 1e-9 * np.abs(one).max()


def test_every_new_preconditioner_has_another_number() -> None:
    with equilibrium_of(NOTCHED, NOTCH, method="factors") as equilibrium:
        old = equilibrium.factors(NOTCH.astype(float))
        equilibrium.renew()
        new = equilibrium.factors(NOTCH.astype(float))
        assert new.number > old.number
        assert equilibrium.holds(new) and not equilibrium.holds(old)
