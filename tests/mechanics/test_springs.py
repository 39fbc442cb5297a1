from dataclasses import replace

import numpy as np
import pytest

from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.laws import SpringLaw
from pearlite_petsc.mechanics.springs import (
    equivalent_length,
    matched_ratio,
    raje_ratio,
    spring_stiffness,
)
from pearlite_petsc.scene import Material
from pearlite_petsc.studies.bodies import plain_mesh, random_points, rotated
from pearlite_petsc.tessellation.mesh import Mesh

E, NU = 206e3, 0.3


def steel(nu: float, springs: str, modulus: float = E) -> Material:
    return Material(modulus, nu, SHIPPED.named(SpringLaw, springs))


def random_mesh() -> Mesh:
    return plain_mesh(random_points(60, 10.0, 8.0, seed=5), 10.0, 8.0)


def scalar_stiffness(mesh: Mesh, interface: int, springs: str, ratio: float) -> tuple[float, float]:
    """One interface's springs, written out from the equations."""
    i, j = mesh.interface_elements[interface].tolist()
    (xi, yi), (xj, yj) = mesh.centre[i].tolist(), mesh.centre[j].tolist()
    nx, ny = mesh.normal[interface].tolist()
    distance = (xj - xi) * nx + (yj - yi) * ny
    if springs == "homogeneous":
        return E / distance, E / distance
    k_n = E / ((1 - NU) * distance)
    if springs == "raje":
        return k_n, E * (1 - 3 * NU) / ((1 - NU**2) * distance)
    return k_n, ratio * k_n


@pytest.mark.parametrize("springs", ["homogeneous", "raje", "matched"])
def test_springs_are_those_of_the_equations_interface_by_interface(springs: str) -> None:
    mesh = random_mesh()
    found = spring_stiffness(mesh, steel(NU, springs), 0.37)
    for interface in range(mesh.interface_count):
        k_n, k_t = scalar_stiffness(mesh, interface, springs, 0.37)
        assert found.k_n[interface] == pytest.approx(k_n, rel=1e-12)
        assert found.k_t[interface] == pytest.approx(k_t, rel=1e-12)


def test_the_equivalent_length_is_the_centres_distance_on_a_voronoi_mesh_and_turns_with_it() -> (
    None
):
    mesh = random_mesh()
    i, j = mesh.interface_elements.T
    distance = np.hypot(*(mesh.centre[j] - mesh.centre[i]).T)
    assert np.allclose(equivalent_length(mesh), distance, rtol=1e-12)
    assert np.allclose(equivalent_length(rotated(mesh, 1.1)), distance, rtol=1e-12)


def test_stiffness_is_proportional_to_the_modulus_and_to_one_over_the_length() -> None:
    mesh = random_mesh()
    single = spring_stiffness(mesh, steel(NU, "raje"))
    double = spring_stiffness(mesh, steel(NU, "raje", 2 * E))
    assert np.array_equal(double.k_t, 2 * single.k_t)
    larger = replace(mesh, centre=2 * mesh.centre)
    assert np.allclose(spring_stiffness(larger, steel(NU, "raje")).k_n, single.k_n / 2, rtol=1e-12)


@pytest.mark.parametrize(("nu", "ratio"), [(0.0, 1.0), (0.25, 0.2), (0.3, 0.1 / 1.3)])
def test_the_ratio_of_the_source_has_its_known_values(nu: float, ratio: float) -> None:
    assert raje_ratio(nu) == pytest.approx(ratio, rel=1e-13)


@pytest.mark.parametrize("nu", [1.0 / 3.0 + 1e-12, 0.4, 0.5, float("nan")])
def test_the_source_springs_refuse_a_third_and_more_and_name_the_value(nu: float) -> None:
    with pytest.raises(PearliteError, match=r"raje.*1/3"):
        spring_stiffness(random_mesh(), steel(nu, "raje"))


def test_the_source_springs_have_the_hookes_law_of_a_hexagonal_packing() -> None:
    # Eq. (24)-(25) come from these two sums over the three directions of a packing.
    k_n, k_t = 1 / (1 - NU), raje_ratio(NU) / (1 - NU)
    assert (k_n + k_t) / 2 == pytest.approx(1 / (1 + NU), rel=1e-13)
    assert (k_n - k_t) / 4 == pytest.approx(NU / (1 - NU**2), rel=1e-13)


def test_centres_out_of_order_along_a_normal_are_refused_with_the_interface() -> None:
    mesh = random_mesh()
    normal = mesh.normal.copy()
    normal[7] *= -1
    with pytest.raises(PearliteError, match=r"interface 7: .* is not positive"):
        spring_stiffness(replace(mesh, normal=normal), steel(NU, "homogeneous"))


def test_matched_springs_without_a_ratio_are_refused() -> None:
    with pytest.raises(PearliteError, match="matched"):
        spring_stiffness(random_mesh(), steel(NU, "matched"))


def test_the_matched_ratio_is_where_the_poisson_ratio_is_met() -> None:
    def poisson(ratio: float) -> float:
        return (1 - ratio) / (3 + ratio)

    assert poisson(matched_ratio(poisson, 0.2)) == pytest.approx(0.2, abs=1e-6)
    with pytest.raises(PearliteError, match=r"not 0\.4"):
        matched_ratio(poisson, 0.4)
    with pytest.raises(PearliteError, match=r"not -0\.5"):
        matched_ratio(poisson, -0.5)
