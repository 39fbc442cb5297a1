"""The direct solver of a whole body: balance, energy, cuts."""

import numpy as np
import pytest

from pearlite_petsc.mechanics.kinematics import rotation_length
from pearlite_petsc.mechanics.loads import uniform_stress, williams_mode_one
from pearlite_petsc.mechanics.springs import HOMOGENEOUS, spring_stiffness
from pearlite_petsc.mechanics.statics import load_vector, operators, solve, solve_loads
from pearlite_petsc.scene import Material
from pearlite_petsc.studies.bodies import on_line, plain_mesh, random_points, tensor_points

EDGES = np.linspace(0.0, 10.0, 11)
GRID = plain_mesh(tensor_points(EDGES, EDGES), 10.0, 10.0)
RANDOM = plain_mesh(random_points(150, 10.0, 10.0, seed=4), 10.0, 10.0)
STEEL = Material(206e3, 0.3, HOMOGENEOUS)
PULL = uniform_stress(0.0, 1.0, 0.0)


def test_the_work_of_the_load_is_the_energy_of_the_springs() -> None:
    springs = spring_stiffness(RANDOM, STEEL)
    found = solve(RANDOM, springs, np.zeros(RANDOM.interface_count, dtype=bool), PULL)
    _, constants = operators(RANDOM, springs)
    assert found.energy == pytest.approx(0.5 * float((found.force**2 / constants).sum()), rel=1e-9)
    assert found.residual < 1e-10


def test_ten_rows_of_squares_stretch_like_nine_between_their_centres() -> None:
    found = solve(GRID, spring_stiffness(GRID, STEEL), on_line(GRID, 5.0, 0.0, 0.0), PULL)
    # Half the stress times the strain times 10 um x 9 um x 1 um.
    assert found.energy == pytest.approx(0.5 / 206e3 * 90.0, rel=1e-9)


def test_a_broken_interface_carries_nothing_and_the_ligament_all() -> None:
    crack = on_line(GRID, 5.0, 0.0, 4.0)
    found = solve(GRID, spring_stiffness(GRID, STEEL), crack, PULL)
    assert crack.sum() == 4
    assert not found.force[crack].any() and not found.traction[crack].any()
    ligament = on_line(GRID, 5.0, 4.0, 10.0)
    assert found.force[ligament, 0].sum() == pytest.approx(10.0, rel=1e-9)


def test_one_factorisation_serves_all_loads() -> None:
    crack, springs = on_line(GRID, 5.0, 0.0, 4.0), spring_stiffness(GRID, STEEL)
    loads = [PULL, williams_mode_one(2e4, (4.0, 5.0))]
    for load, found in zip(loads, solve_loads(GRID, springs, crack, loads), strict=True):
        alone = solve(GRID, springs, crack, load)
        assert np.array_equal(found.unknowns, alone.unknowns)


def test_the_load_vector_scales_moments_by_the_rotation_length() -> None:
    load = load_vector(RANDOM, williams_mode_one(2e4, (4.0, 5.0)))
    moment = load[:, 2] * rotation_length(RANDOM)
    about_origin = moment + RANDOM.centre[:, 0] * load[:, 1] - RANDOM.centre[:, 1] * load[:, 0]
    assert abs(about_origin.sum()) < 1e-9 * np.abs(about_origin).max()
