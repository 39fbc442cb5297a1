"""A cycle jump that returns what cannot be is refused, with what and where."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.errors import PearliteError
from pearlite_petsc.fatigue.cycle_jumps.euler import Euler
from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Situation, Trial
from pearlite_petsc.growth.block_check import refuse_impossible
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import prepare_growth
from tests.scenes import STATES, default_scene

BEFORE = np.array([0.2, 1.0, 0.0])
AFTER = np.array([0.3, 1.0, 1.0])


@pytest.mark.parametrize("kind", [Block, Trial])
@pytest.mark.parametrize(
    ("cycles", "damage", "message"),
    [
        (0.0, AFTER, "cycles are 0, not positive and finite"),
        (-3.0, AFTER, "cycles are -3, not positive and finite"),
        (np.nan, AFTER, "cycles are nan, not positive and finite"),
        (np.inf, AFTER, "cycles are inf, not positive and finite"),
        (1.0, AFTER[:2], r"damage has the shape \(2,\), not \(3,\)"),
        (1.0, [0.3, 1.0, 1.1], "damage of interface 2 is 1.1, not within 0 and 1"),
        (1.0, [np.nan, 1.0, 1.0], "damage of interface 0 is nan, not within 0"),
    ],
)
def test_what_cannot_be_is_refused(
    kind: type[Block] | type[Trial], cycles: float, damage: Any, message: str
) -> None:
    with pytest.raises(PearliteError, match=message):
        refuse_impossible(MPI.COMM_SELF, kind(cycles, np.array(damage)), BEFORE)


def test_damage_falls_in_no_block_but_may_on_trial() -> None:
    healed = np.array([0.1, 1.0, 0.0])
    with pytest.raises(PearliteError, match="block's damage of interface 0 is 0.1, not within 0.2"):
        refuse_impossible(MPI.COMM_SELF, Block(1.0, healed), BEFORE)
    refuse_impossible(MPI.COMM_SELF, Trial(1.0, healed), BEFORE)
    refuse_impossible(MPI.COMM_SELF, Block(1.0, AFTER), BEFORE)


def no_cycles(start: Situation, settings: Any) -> Block | None:
    block = Euler(settings.delta_d)(start)
    return None if block is None else replace(block, cycles=0.0)


def healing(start: Situation, settings: Any) -> Block | None:
    return Block(10.0, 0.5 * start.damage)


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (no_cycles, "the block's cycles are 0"),
        (healing, "the block's damage of interface .* is 0.5"),
        (lambda start, settings: (10.0, start.damage), "gave tuple, not a Block or Trial"),
    ],
)
def test_a_crack_of_a_wrong_cycle_jump_ends_with_its_fault(
    function: Callable[..., Any], message: str
) -> None:
    scene = default_scene(
        window={"width": 60.0, "height": 60.0, "notch": 25.0},
        elements={"width": 3.0, "length": 6.0},
        cycle_jump={"delta_d": 0.5},
    )
    wrong = replace(scene.cycle_jump.method, name="wrong", function=function)
    scene = replace(scene, cycle_jump=replace(scene.cycle_jump, method=wrong))
    prepared = prepare_growth(scene, STATES["severe_AT"], 0)
    with (
        CrackGrowth(MPI.COMM_SELF, scene, STATES["severe_AT"], 18e3, prepared) as growth,
        pytest.raises(PearliteError, match=f"cycle jump: {message}"),
    ):
        list(growth.steps())
