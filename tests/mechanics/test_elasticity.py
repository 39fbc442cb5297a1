import numpy as np
import pytest

from pearlite_petsc.errors import PearliteError
from pearlite_petsc.mechanics import springs
from pearlite_petsc.mechanics.elasticity import certificate, ratio_of_mesh, solve_uniform
from pearlite_petsc.mechanics.springs import raje_ratio, spring_stiffness
from pearlite_petsc.scene import Material
from pearlite_petsc.studies.bodies import plain_mesh, random_points, rotated, tensor_points

E, NU = 206e3, 0.3
HOMOGENEOUS = Material(E, NU, springs.HOMOGENEOUS)
RAJE = Material(E, NU, springs.RAJE)
EDGES = np.linspace(0.0, 12.0, 9)
SQUARE = plain_mesh(tensor_points(EDGES, EDGES), 12.0, 12.0)
RANDOM = plain_mesh(random_points(120, 12.0, 12.0, seed=9), 12.0, 12.0)


def test_homogeneous_springs_show_e_no_nu_and_half_e_as_shear_modulus() -> None:
    found = certificate(RANDOM, spring_stiffness(RANDOM, HOMOGENEOUS))
    assert found.e_x == pytest.approx(E, rel=1e-9)
    assert found.e_y == pytest.approx(E, rel=1e-9)
    assert found.g == pytest.approx(E / 2, rel=1e-9)
    assert max(abs(found.nu_xy), abs(found.nu_yx), found.coupling, found.stress_error) < 1e-9


def test_the_source_springs_on_squares_have_the_moduli_of_two_rows_of_springs() -> None:
    # Tension stretches only the normal springs; pure shear slides both families, none turns.
    found = certificate(SQUARE, spring_stiffness(SQUARE, RAJE))
    k_n = E / (1 - NU)
    assert found.e_x == pytest.approx(k_n, rel=1e-9)
    assert found.e_y == pytest.approx(k_n, rel=1e-9)
    assert found.g == pytest.approx(raje_ratio(NU) * k_n / 2, rel=1e-9)
    assert abs(found.nu_xy) < 1e-12


def test_compliance_is_symmetric_as_maxwell_and_betti_ask() -> None:
    found = certificate(RANDOM, spring_stiffness(RANDOM, RAJE)).compliance
    # The strain is a fit, so that symmetry holds to its accuracy, not to rounding.
    assert abs(found[0, 1] - found[1, 0]) < 0.1 * abs(found[0, 1])
    assert found[0, 1] < 0 < found[0, 0]


def test_a_mesh_turned_by_a_right_angle_swaps_its_constants() -> None:
    mesh = RANDOM
    turned = rotated(mesh, 0.5 * np.pi)
    here = certificate(mesh, spring_stiffness(mesh, RAJE))
    there = certificate(turned, spring_stiffness(turned, RAJE))
    assert there.e_x == pytest.approx(here.e_y, rel=1e-9)
    assert there.nu_xy == pytest.approx(here.nu_yx, rel=1e-9)
    assert there.g == pytest.approx(here.g, rel=1e-9)


def test_loads_superpose() -> None:
    stresses = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, -3.0, 0.0]])
    motions, tractions = solve_uniform(RANDOM, spring_stiffness(RANDOM, RAJE), stresses)
    assert np.allclose(2 * tractions[0] - 3 * tractions[1], tractions[2], rtol=0, atol=1e-9)
    assert np.allclose(2 * motions[0] - 3 * motions[1], motions[2], rtol=0, atol=1e-12)


def test_the_stress_averaged_over_all_interfaces_is_the_applied_one() -> None:
    # Love's formula; it holds for any springs.
    for material in (HOMOGENEOUS, RAJE):
        _, tractions = solve_uniform(
            RANDOM, spring_stiffness(RANDOM, material), np.array([[1.0, -2.0, 0.5]])
        )
        tangent = np.stack([-RANDOM.normal[:, 1], RANDOM.normal[:, 0]], axis=1)
        force = tractions[0][:, :1] * RANDOM.normal + tractions[0][:, 1:] * tangent
        force = force * RANDOM.length[:, None]
        i, j = RANDOM.interface_elements.T
        branch = RANDOM.centre[j] - RANDOM.centre[i]
        inner = np.einsum("ka,kb->ab", branch, force)
        start, end = RANDOM.vertices[RANDOM.boundary_vertices].transpose(1, 0, 2)
        step = end - start
        outward = np.stack([step[:, 1], -step[:, 0]], axis=1)
        outer = outward @ np.array([[1.0, 0.5], [0.5, -2.0]])
        arm = 0.5 * (start + end) - RANDOM.centre[RANDOM.boundary_elements]
        mean = (inner + np.einsum("ka,kb->ab", arm, outer)) / 144.0
        assert np.allclose(mean, [[1.0, 0.5], [0.5, -2.0]], atol=1e-9)


def test_matched_springs_show_the_poisson_ratio() -> None:
    material = Material(E, 0.2, springs.MATCHED)
    ratio = ratio_of_mesh(RANDOM, material)
    assert ratio is not None
    found = certificate(RANDOM, spring_stiffness(RANDOM, material, ratio))
    assert 0.5 * (found.nu_xy + found.nu_yx) == pytest.approx(0.2, abs=1e-5)
    assert 0.5 * (found.e_x + found.e_y) == pytest.approx(E, rel=0.02)


def test_matched_springs_that_a_mesh_cannot_have_are_refused() -> None:
    with pytest.raises(PearliteError, match="matched"):
        ratio_of_mesh(SQUARE, Material(E, NU, springs.MATCHED))


def test_other_springs_need_no_ratio() -> None:
    assert ratio_of_mesh(RANDOM, HOMOGENEOUS) is None
    assert ratio_of_mesh(RANDOM, RAJE) is None
