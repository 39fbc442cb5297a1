"""The stiffness matrix: what it sums, what it declares to PETSc, and that updates do not drift."""

import numpy as np
import pytest
from mpi4py import MPI
from scipy.sparse import csr_array

from pearlite_petsc.mechanics.kinematics import rigid_modes
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.solver import matrix
from pearlite_petsc.solver.subdomain import subdomain_of
from tests.solver.bodies import RANDOM, STEEL


def test_many_updates_leave_the_matrix_of_a_new_assembly() -> None:
    rng = np.random.default_rng(2)
    subdomain = subdomain_of(RANDOM, spring_stiffness(RANDOM, STEEL), 0, RANDOM.element_count)
    operator, damage = subdomain.jump_operator(), np.zeros(RANDOM.interface_count)
    with matrix.StiffnessMatrix(MPI.COMM_SELF, subdomain, operator, damage) as kept:
        for _ in range(200):
            chosen = rng.integers(0, len(damage), 40)
            damage = damage.copy()
            damage[chosen] = np.minimum(1.0, damage[chosen] + rng.random(40))
            kept.update(damage)
        assert (damage == 1.0).sum() > 1000
        with matrix.StiffnessMatrix(MPI.COMM_SELF, subdomain, operator, damage) as fresh:
            assert np.array_equal(kept.mat.getValuesCSR()[2], fresh.mat.getValuesCSR()[2])


def test_broken_interfaces_add_nothing_and_leave_the_ground_and_three_supports() -> None:
    subdomain = subdomain_of(RANDOM, spring_stiffness(RANDOM, STEEL), 0, RANDOM.element_count)
    broken, held = np.ones(RANDOM.interface_count), []
    for damage in (broken, 0.0 * broken):
        with matrix.StiffnessMatrix(
            MPI.COMM_SELF, subdomain, subdomain.jump_operator(), damage
        ) as stiffness:
            offsets, columns, values = stiffness.mat.getValuesCSR()
            rows = np.repeat(np.arange(3 * subdomain.owned_count), np.diff(offsets))
            if damage.any():
                assert not values[rows != columns].any()
            held.append(values[rows == columns].reshape(-1, 3))
    fraction = held[0] / held[1].mean(axis=1, keepdims=True)
    supports = np.argwhere(fraction > 0.5 * matrix.SUPPORT)
    x, y = RANDOM.centre.T
    left, right = np.argmin(x + y), np.argmin(y - x)
    assert sorted(supports.tolist()) == sorted([[left, 0], [left, 1], [right, 1]])
    assert fraction[tuple(supports.T)] == pytest.approx(matrix.SUPPORT, rel=0.01)
    fraction[tuple(supports.T)] = matrix.GROUNDING
    assert fraction == pytest.approx(matrix.GROUNDING, rel=0.01)


def test_values_are_the_sum_of_the_springs_of_all_interfaces() -> None:
    subdomain = subdomain_of(RANDOM, spring_stiffness(RANDOM, STEEL), 0, RANDOM.element_count)
    damage = np.random.default_rng(4).random(RANDOM.interface_count)
    operator, constants = subdomain.jump_operator(), subdomain.interfaces.spring_constants()
    size = 3 * RANDOM.element_count
    wanted = np.zeros((size, size))
    for number, elements in enumerate(RANDOM.interface_elements):
        unknowns = (3 * elements[:, None] + np.arange(3)).ravel()
        springs = (1.0 - damage[number]) * np.diag(constants[number])
        wanted[np.ix_(unknowns, unknowns)] += operator[number].T @ springs @ operator[number]
    with matrix.StiffnessMatrix(MPI.COMM_SELF, subdomain, operator, damage) as stiffness:
        offsets, columns, values = stiffness.mat.getValuesCSR()
        found = csr_array((values, columns, offsets), shape=(size, size)).toarray()
    held = found - wanted
    largest = np.abs(wanted).max()
    assert np.abs(found - found.T).max() < 1e-15 * largest
    assert np.abs(held - np.diag(np.diag(held))).max() < 1e-13 * largest
    assert (np.diag(held) > 0.1 * matrix.SUPPORT * largest).sum() == 3


def test_petsc_knows_its_symmetry_and_its_rigid_modes_also_after_an_update() -> None:
    subdomain = subdomain_of(RANDOM, spring_stiffness(RANDOM, STEEL), 0, RANDOM.element_count)
    intact = np.zeros(RANDOM.interface_count)
    modes = rigid_modes(RANDOM.centre, subdomain.rotation_length, RANDOM.centre.mean(axis=0))
    with matrix.StiffnessMatrix(
        MPI.COMM_SELF, subdomain, subdomain.jump_operator(), intact
    ) as stiffness:
        stiffness.update(intact + 0.5)
        assert stiffness.mat.isSymmetricKnown() == (True, True)
        vectors = [vec.getArray() for vec in stiffness.mat.getNearNullSpace().getVecs()]
    spanned = np.stack(vectors, axis=1)
    assert spanned.T @ spanned == pytest.approx(np.eye(3), abs=1e-12)
    rigid = modes.reshape(-1, 3)
    assert np.abs(rigid - spanned @ (spanned.T @ rigid)).max() < 1e-12 * np.abs(rigid).max()
