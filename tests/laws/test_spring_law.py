"""What a spring law returns is checked before it meets the solver."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pearlite_petsc.errors import PearliteError
from pearlite_petsc.laws import SpringInterfaces, SpringLaw
from pearlite_petsc.mechanics.springs import HOMOGENEOUS, MATCHED, Stiffness, spring_stiffness
from pearlite_petsc.scene import Material
from pearlite_petsc.studies.bodies import plain_mesh, random_points

MESH = plain_mesh(random_points(20, 10.0, 8.0, seed=5), 10.0, 8.0)
ONES = np.ones(MESH.interface_count)


def law_that_returns(found: Any) -> Material:
    law = SpringLaw(name="own", help="for tests", function=lambda interfaces, material: found)
    return Material(206e3, 0.3, law)


@pytest.mark.parametrize(
    ("returned", "message"),
    [
        (ONES, "returns ndarray, not Stiffness"),
        (Stiffness(ONES[1:], ONES), r"k_n has shape"),
        (Stiffness(ONES, 0.0 * ONES), "interface 0: k_t 0 MPa/um is not finite and positive"),
        (Stiffness(np.nan * ONES, ONES), "interface 0: k_n nan"),
    ],
)
def test_springs_that_no_body_can_have_are_refused_with_the_laws_name(
    returned: Any, message: str
) -> None:
    with pytest.raises(PearliteError, match=rf'^\[material\] springs = "own".*{message}'):
        spring_stiffness(MESH, law_that_returns(returned))


def test_a_law_sees_the_geometry_of_every_interface() -> None:
    seen: list[SpringInterfaces] = []

    def own(interfaces: SpringInterfaces, material: Material) -> Stiffness:
        seen.append(interfaces)
        return Stiffness(ONES, ONES)

    law = replace(HOMOGENEOUS, function=own)
    spring_stiffness(MESH, Material(206e3, 0.3, law))
    assert np.array_equal(seen[0].length, MESH.length)
    assert np.array_equal(seen[0].midpoint, MESH.midpoint)
    assert (seen[0].centre_distance > 0.0).all()


def test_a_law_that_meets_the_poisson_ratio_must_take_the_ratio() -> None:
    with pytest.raises(ValueError, match=r"does not take .*ratio="):
        replace(MATCHED, function=lambda interfaces, material: None)
