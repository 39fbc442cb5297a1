import numpy as np
import pytest

from pearlite_petsc.fatigue.cycle_jumps.compliance import (
    ABOUT_TO_BREAK,
    MOST_TRIES,
    Compliance,
)
from tests.fatigue.cycle_jumps.body import COUNT, Body

NEARLY_EVEN = 27
"""Seed of a body where another spring than the one foreseen breaks, as the solve shows."""


def test_a_block_that_the_solve_bears_out_takes_one_solve() -> None:
    body = Body()
    block = body.block(Compliance(1.0), body.situation(np.zeros(COUNT)))
    assert block is not None and block.counts == {"undone": 0}
    assert len(body.trials) == 1
    assert np.array_equal(block.damage >= 1.0, body.trials[0].damage >= 1.0)


def test_breaks_that_the_solve_does_not_bear_out_are_undone() -> None:
    body = Body(seed=NEARLY_EVEN, most_coupled=1)
    damage, undone = np.zeros(COUNT), 0
    for _ in range(4):
        body.trials.clear()
        block = body.block(Compliance(1.0), body.situation(damage))
        if block is None:
            break
        undone += block.counts["undone"]
        assert len(body.trials) == block.counts["undone"] + 1 <= MOST_TRIES + 1
        breaks = [trial.damage >= 1.0 for trial in body.trials]
        assert np.array_equal(breaks[-1], block.damage >= 1.0)
        damage = block.damage
    assert undone == 1


def test_springs_that_were_not_seen_to_soften_do_not_break() -> None:
    body = Body(most_coupled=1)
    almost = np.array([0.0, 0.0, 0.0, 0.985, 0.985])
    block = body.block(Compliance(1.0), body.situation(almost))
    assert block is not None
    assert (block.damage >= 1.0).sum() == 1
    assert block.damage.max(where=block.damage < 1.0, initial=0.0) <= ABOUT_TO_BREAK


def test_a_smaller_step_of_released_force_takes_more_blocks_to_the_same_break() -> None:
    body = Body()
    whole, fine = (body.until_first_break(Compliance(step)) for step in (1.0, 0.2))
    assert (whole[2], fine[2]) == (1, 5)
    assert whole[0] == pytest.approx(fine[0], rel=1e-3)
