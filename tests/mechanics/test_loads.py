import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.mechanics.loads import (
    element_forces,
    facet_forces,
    uniform_stress,
    williams_mode_one,
)
from pearlite_petsc.studies.bodies import plain_mesh, random_points

K, TIP = 3.0, (4.0, 5.0)


def williams_stress(x: float, y: float) -> tuple[float, float, float]:
    """Mode-I stresses (xx, yy, xy) of the textbooks at a point."""
    dx, dy = x - TIP[0], y - TIP[1]
    r, angle = math.hypot(dx, dy), math.atan2(dy, dx)
    factor = K / math.sqrt(2 * math.pi * r) * math.cos(angle / 2)
    product = math.sin(angle / 2) * math.sin(3 * angle / 2)
    shear = math.sin(angle / 2) * math.cos(3 * angle / 2)
    return factor * (1 - product), factor * (1 + product), factor * shear


def integrated(start: FloatArray, end: FloatArray, centre: FloatArray) -> list[float]:
    """(F_x, F_y, M) of the textbook's tractions on one facet, outward normal to its right."""
    step = end - start
    length = float(np.hypot(*step))
    nx, ny = step[1] / length, -step[0] / length

    def traction(part: float) -> tuple[float, float, float]:
        x, y = (start + part * step).tolist()
        xx, yy, xy = williams_stress(x, y)
        fx, fy = xx * nx + xy * ny, xy * nx + yy * ny
        return fx, fy, (x - centre[0]) * fy - (y - centre[1]) * fx

    return [
        length * quad(lambda part, row=row: traction(part)[row], 0, 1, epsabs=1e-12)[0]
        for row in range(3)
    ]


def test_the_forces_of_k_field_are_integrals_of_the_textbook_stresses() -> None:
    corners = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 7.0], [6.0, 9.0], [1.0, 8.0]])
    for start, end in itertools.pairwise(corners):
        centre = np.array([3.0, 2.0])
        found = facet_forces(start[None], end[None], centre[None], williams_mode_one(K, TIP))[0]
        assert found == pytest.approx(integrated(start, end, centre), abs=1e-9)


def test_the_faces_of_the_crack_are_free_of_traction() -> None:
    # Just above and just below the cut along -x.
    for side in (1e-13, -1e-13):
        start = np.array([[0.0, TIP[1] + side]])
        end = np.array([[3.5, TIP[1] + side]])
        found = facet_forces(start, end, np.zeros((1, 2)), williams_mode_one(K, TIP))
        assert np.abs(found).max() < 1e-11


def test_ahead_of_the_tip_the_stress_opens_the_crack() -> None:
    # The upper side of the ligament: its outward normal is -y, the body below pulls it down.
    length = 2.0
    start, end = np.array([TIP]), np.array([[TIP[0] + length, TIP[1]]])
    force = facet_forces(start, end, np.zeros((1, 2)), williams_mode_one(K, TIP))[0]
    assert force[0] == pytest.approx(0.0, abs=1e-14)
    assert force[1] == pytest.approx(-K * math.sqrt(2 * length / math.pi), rel=1e-12)


def test_a_uniform_stress_acts_as_stress_times_outward_normal_times_length() -> None:
    rng = np.random.default_rng(8)
    start, end, centre = rng.normal(size=(3, 20, 2))
    xx, yy, xy = 2.0, -3.0, 0.7
    found = facet_forces(start, end, centre, uniform_stress(xx, yy, xy))
    step = end - start
    outward = np.stack([step[:, 1], -step[:, 0]], axis=1)
    force = outward @ np.array([[xx, xy], [xy, yy]])
    arm = 0.5 * (start + end) - centre
    assert np.allclose(found[:, :2], force, atol=1e-13)
    assert np.allclose(found[:, 2], arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0], atol=1e-12)


def test_tension_along_y_pulls_the_top_up_and_the_bottom_down() -> None:
    top = facet_forces(
        np.array([[3.0, 2.0]]), np.array([[1.0, 2.0]]), np.zeros((1, 2)), uniform_stress(0, 5.0, 0)
    )
    bottom = facet_forces(
        np.array([[1.0, 0.0]]), np.array([[3.0, 0.0]]), np.zeros((1, 2)), uniform_stress(0, 5.0, 0)
    )
    assert top[0, 1] == pytest.approx(10.0)
    assert bottom[0, 1] == pytest.approx(-10.0)


@pytest.mark.parametrize("tip", [(4.0, 5.0), (4.0, 4.0), (0.3, 6.9)])
def test_every_load_balances_itself_whatever_the_facets(tip: tuple[float, float]) -> None:
    mesh = plain_mesh(random_points(80, 10.0, 8.0, seed=2), 10.0, 8.0)
    start, end = (mesh.vertices[mesh.boundary_vertices[:, side]] for side in (0, 1))
    for airy in (williams_mode_one(2e4, tip), uniform_stress(3.0, 7.0, -2.0)):
        forces = facet_forces(start, end, np.zeros_like(start), airy)
        assert (np.abs(forces.sum(axis=0)) < 1e-12 * np.abs(forces).sum(axis=0)).all()


def test_splitting_a_facet_splits_its_force() -> None:
    a, b, c = np.array([[0.0, 0.0]]), np.array([[4.0, 0.0]]), np.array([[10.0, 0.0]])
    airy, centre = williams_mode_one(K, TIP), np.array([[5.0, 1.0]])
    parts = facet_forces(a, b, centre, airy) + facet_forces(b, c, centre, airy)
    assert np.allclose(parts, facet_forces(a, c, centre, airy), atol=1e-13)


def test_the_load_is_proportional_to_k_and_symmetric_about_the_crack() -> None:
    start, end, centre = np.array([[10.0, 5.0]]), np.array([[10.0, 7.0]]), np.array([[9.0, 6.0]])
    single = facet_forces(start, end, centre, williams_mode_one(K, TIP))[0]
    double = facet_forces(start, end, centre, williams_mode_one(2 * K, TIP))[0]
    assert np.array_equal(double, 2 * single)

    def flip(points: FloatArray) -> FloatArray:
        return points * [1.0, -1.0] + [0.0, 2 * TIP[1]]

    mirrored = facet_forces(flip(end), flip(start), flip(centre), williams_mode_one(K, TIP))[0]
    assert mirrored == pytest.approx(single * [1.0, -1.0, -1.0], abs=1e-12)


def test_the_facets_of_an_element_add_up_and_elements_inside_carry_no_load() -> None:
    airy = williams_mode_one(K, TIP)
    mesh = plain_mesh(random_points(60, 8.0, 8.0, seed=1), 8.0, 8.0)
    start, end = (mesh.vertices[mesh.boundary_vertices[:, side]] for side in (0, 1))
    found = element_forces(start, end, mesh.boundary_elements, mesh.centre, airy)
    facets = facet_forces(start, end, mesh.centre[mesh.boundary_elements], airy)
    assert len(facets) > len(np.unique(mesh.boundary_elements))
    for element in range(mesh.element_count):
        own = facets[mesh.boundary_elements == element]
        assert np.allclose(found[element], own.sum(axis=0), rtol=1e-12)
