"""The equations at a damage that moves on: what they are given and give back."""

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.scene import Kind
from pearlite_petsc.solver.subdomain import subdomain_of
from pearlite_petsc.solver.system import LinearSystem
from tests.solver.bodies import NOTCHED, STEEL

RNG = np.random.default_rng(12)


def system() -> LinearSystem:
    subdomain = subdomain_of(NOTCHED, spring_stiffness(NOTCHED, STEEL), 0, NOTCHED.element_count)
    return LinearSystem(MPI.COMM_SELF, subdomain, (NOTCHED.kind == Kind.NOTCH).astype(float))


def test_its_damage_is_compared_by_value_and_cannot_be_changed_from_outside() -> None:
    with system() as equations:
        start = equations.damage
        assert equations.has_damage(start.copy())
        given = np.full(NOTCHED.interface_count, 0.25)
        equations.update(given)
        assert equations.has_damage(np.full(NOTCHED.interface_count, 0.25))
        assert not equations.has_damage(start)
        with pytest.raises(ValueError, match="read-only"):
            given[0] = 1.0


def test_the_solution_is_a_copy_and_the_residual_that_of_the_load() -> None:
    with system() as equations:
        unknowns = RNG.normal(size=(NOTCHED.element_count, 3))
        equations.start_from(unknowns)
        solution = equations.solution()
        assert np.array_equal(solution, unknowns)
        assert np.array_equal(equations.unknowns(), unknowns)
        equations.start_from(0.0 * unknowns)
        assert np.array_equal(solution, unknowns)
        equations.set_load(np.ones((NOTCHED.element_count, 3)))
        assert equations.relative_residual() == pytest.approx(1.0, rel=1e-12)
        # The load that these unknowns are the answer to.
        equations.start_from(unknowns)
        equations.matrix.mat.mult(equations.x, equations.b)
        assert equations.relative_residual() < 1e-12


def test_rigid_motions_open_nothing() -> None:
    with system() as equations:
        moved = np.zeros((NOTCHED.element_count, 3))
        moved[:, :2] = 0.3, -0.7
        assert np.abs(equations.jumps(moved)).max() < 1e-12
        moved[5, 0] += 0.1
        touched = np.isin(NOTCHED.interface_elements, 5).any(axis=1)
        opened = np.abs(equations.jumps(moved)).max(axis=1)
        assert (opened[touched] > 1e-3).all() and (opened[~touched] < 1e-12).all()
