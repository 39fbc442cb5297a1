"""What a damage law declares is held; what it returns is checked."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.fatigue.damage import OBJECTIVE, crack_distance, damage_interfaces
from pearlite_petsc.laws import (
    DamageInterfaces,
    DamageLaw,
    Laws,
    Limits,
    RateConstants,
    Source,
    number,
)
from pearlite_petsc.scene import Damage
from tests.scenes import STATES, default_scene

DAMAGE = default_scene().damage
STATE = STATES["moderate_AT"]
INTERFACES = damage_interfaces(np.array([2.0, 4.0]), np.array([0, 1]), DAMAGE, STATE, 55.0)


def constant(interfaces: DamageInterfaces, damage: Damage, *, thickness: float) -> RateConstants:
    return RateConstants(np.full(len(interfaces.length), thickness), interfaces.length, damage.beta)


LAW = DamageLaw(
    name="constant",
    help="for tests",
    function=constant,
    parameters=(number("thickness", 20.0, "nm", Limits(1.0, 100.0), "nm"),),
)


def test_parameters_reach_the_function_in_the_programs_units() -> None:
    assert LAW.rate_constants(INTERFACES, DAMAGE).factor.tolist() == [0.02, 0.02]
    other = LAW.with_values(thickness=0.05)
    assert other.rate_constants(INTERFACES, DAMAGE).factor.tolist() == [0.05, 0.05]
    assert other != LAW
    assert other.with_values(thickness=0.02).keywords() == LAW.keywords()


def test_laws_are_equal_by_what_they_declare_and_where_they_come_from() -> None:
    assert replace(LAW, function=lambda interfaces, damage, thickness: None) == LAW
    assert replace(LAW, source=Source("a.py", "0" * 64)) != LAW


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": "soft film"}, 'name "soft film" must be letters'),
        ({"parameters": ()}, "does not take .*: missing a required argument: 'thickness'"),
        ({"function": lambda interfaces: None}, "does not take"),
        ({"parameters": LAW.parameters * 2}, "thickness is declared twice"),
        ({"values": (("width", 1.0),)}, "has no parameter width"),
    ],
)
def test_a_declaration_that_does_not_fit_its_function_is_refused(
    changes: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        replace(LAW, **changes)


def test_a_parameter_with_an_unknown_unit_or_a_default_beyond_its_limits_is_refused() -> None:
    with pytest.raises(ValueError, match=r'unit "inch" is unknown, known are .*"um"'):
        number("thickness", 1.0, "", Limits(0.0, 2.0), "inch")
    with pytest.raises(ValueError, match="the default 3 must be at least 0 and at most 2"):
        number("thickness", 3.0, "", Limits(0.0, 2.0), "um")


@pytest.mark.parametrize(
    ("returned", "message"),
    [
        (None, "returns NoneType, not RateConstants"),
        (RateConstants(np.ones(3), np.ones(2), 0.3), r"factor has shape \(3,\), not \(2,\)"),
        (RateConstants(np.ones(2), np.array([1.0, -1.0]), 0.3), "interface 1: threshold -1 is not"),
        (RateConstants(np.array([math.inf, 1.0]), np.ones(2), 0.3), "interface 0: factor inf is"),
        (RateConstants(np.ones(2), np.ones(2), math.nan), "beta nan"),
    ],
)
def test_constants_that_no_interface_can_have_are_refused_with_the_laws_name(
    returned: Any, message: str
) -> None:
    law = replace(LAW, function=lambda interfaces, damage, thickness: returned)
    with pytest.raises(PearliteError, match=rf'^\[damage\] law = "constant".*{message}'):
        law.rate_constants(INTERFACES, DAMAGE)


def test_an_error_inside_a_law_names_the_law_and_its_file() -> None:
    def faulty(interfaces: DamageInterfaces, damage: Damage, *, thickness: float) -> RateConstants:
        raise KeyError("no such thing")

    law = replace(LAW, function=faulty, source=Source("my_law.py", "0" * 64))
    with pytest.raises(PearliteError, match=r'"constant" of my_law\.py fails: KeyError: .no such'):
        law.rate_constants(INTERFACES, DAMAGE)


def test_a_catalogue_refuses_a_second_law_of_the_same_name_and_stays_as_it_was() -> None:
    laws = Laws((OBJECTIVE,))
    assert laws.joined([LAW]).of(DamageLaw) == (OBJECTIVE, LAW)
    assert laws.of(DamageLaw) == (OBJECTIVE,)
    with pytest.raises(SceneError, match="one of this name exists in the program itself"):
        laws.joined([replace(LAW, name="objective")])


@given(
    points=st.lists(st.tuples(*2 * [st.floats(-50, 50)]), min_size=1, max_size=5),
    ends=st.lists(st.tuples(*4 * [st.floats(-50, 50)]), min_size=1, max_size=90),
)
def test_the_distance_from_the_crack_is_the_least_over_all_points_of_its_interfaces(
    points: list[tuple[float, float]], ends: list[tuple[float, float, float, float]]
) -> None:
    found = crack_distance(np.array(points), np.array(ends).reshape(-1, 2, 2))
    for point, distance in zip(points, found.tolist(), strict=True):
        nearest = min(scalar_distance(point, end) for end in ends)
        assert distance == pytest.approx(nearest, rel=1e-6, abs=1e-6)


def scalar_distance(point: tuple[float, float], end: tuple[float, float, float, float]) -> float:
    """Smallest distance from a point of the segment, by thirds."""
    low, high = 0.0, 1.0

    def at(part: float) -> float:
        x, y = end[0] + part * (end[2] - end[0]), end[1] + part * (end[3] - end[1])
        return math.hypot(point[0] - x, point[1] - y)

    for _ in range(200):
        third = (high - low) / 3
        if at(low + third) < at(high - third):
            high -= third
        else:
            low += third
    return at(0.5 * (low + high))
