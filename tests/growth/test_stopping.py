"""Why a crack ends, and that the first reason of several counts."""

import pytest

from pearlite_petsc.fatigue.outcome import StopReason
from pearlite_petsc.growth.stopping import has_left_corridor, reason_to_stop, touches_edge
from tests.scenes import default_scene

SCENE = default_scene(
    window={"width": 100.0, "height": 80.0, "notch": 40.0},
    elements={"width": 2.0, "length": 6.0, "corridor": 20.0, "refinement": "corridor"},
    loading={"extension": 30.0},
    solver={"max_solves": 50},
)


@pytest.mark.parametrize(
    ("point", "touches"),
    [
        ((94.1, 40.0), True),
        ((93.9, 40.0), False),
        ((50.0, 74.1), True),
        ((50.0, 73.9), False),
        ((50.0, 5.9), True),
        ((50.0, 6.1), False),
        # The left edge is where the notch begins.
        ((0.0, 40.0), False),
    ],
)
def test_the_window_edge_begins_one_element_inside(
    point: tuple[float, float], touches: bool
) -> None:
    assert touches_edge(SCENE, [(50.0, 40.0), point]) == touches


def test_a_corridor_is_left_two_elements_before_its_edge() -> None:
    # 20 - 2 * 6 = 8 um off the middle.
    assert not has_left_corridor(SCENE, [(50.0, 47.9), (50.0, 32.1)])
    assert has_left_corridor(SCENE, [(50.0, 48.1)])
    assert has_left_corridor(SCENE, [(50.0, 31.9)])
    follows = default_scene(elements={"refinement": "follow"})
    assert not has_left_corridor(follows, [(50.0, 0.0)])


def test_reasons_count_in_their_order() -> None:
    inside, at_edge, outside = [(50.0, 40.0)], [(99.0, 40.0)], [(50.0, 60.0)]
    assert reason_to_stop(SCENE, 29.9, inside, 49) is None
    assert reason_to_stop(SCENE, 30.0, at_edge, 50) is StopReason.GROWN
    assert reason_to_stop(SCENE, 29.9, at_edge, 50) is StopReason.BOUNDARY
    assert reason_to_stop(SCENE, 29.9, outside, 50) is StopReason.LEFT_REFINED_ZONE
    assert reason_to_stop(SCENE, 29.9, inside, 50) is StopReason.MAX_SOLVES
