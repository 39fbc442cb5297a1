"""Every cycle jump against an ODE solver on springs that share their load with a body."""

from functools import partial

import numpy as np
import pytest

from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.fatigue.cycle_jumps.situation import CycleJumpMethod
from pearlite_petsc.laws.cycle_jump import CycleJumpLaw
from pearlite_petsc.laws.law import called
from pearlite_petsc.scene import CycleJump
from tests.fatigue.cycle_jumps.body import COUNT, Body

METHODS = [law.name for law in SHIPPED.of(CycleJumpLaw)]


def method_of(name: str, delta_d: float, tolerance: float = 0.01) -> CycleJumpMethod:
    law = SHIPPED.named(CycleJumpLaw, name)
    return partial(called, law, settings=CycleJump(law, delta_d, tolerance))


@pytest.mark.parametrize(
    ("name", "delta_d", "error"),
    [
        ("euler", 0.02, 0.03),
        ("exponential", 0.1, 0.01),
        ("heun", 0.1, 0.006),
        ("compliance", 1.0, 1e-3),
        ("adaptive", 0.5, 1e-3),
    ],
)
@pytest.mark.parametrize("seed", [0, 2, 3])
def test_the_first_spring_breaks_when_the_ode_solver_says(
    name: str, delta_d: float, error: float, seed: int
) -> None:
    body = Body(seed=seed)
    cycles, damage = body.exact()
    found, damaged, _ = body.until_first_break(method_of(name, delta_d))
    assert found == pytest.approx(cycles, rel=error)
    assert damaged == pytest.approx(damage, abs=0.01)
    assert np.argmax(damaged) == np.argmax(damage)


@pytest.mark.parametrize(("name", "order"), [("euler", 1.0), ("heun", 2.0)])
def test_errors_fall_with_the_order_of_the_method(name: str, order: float) -> None:
    body = Body()
    exact, _ = body.exact()
    errors = [
        abs(body.until_first_break(method_of(name, step))[0] / exact - 1.0) for step in (0.1, 0.05)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.35)


@pytest.mark.parametrize("name", METHODS)
def test_below_the_threshold_nothing_goes_on(name: str) -> None:
    body = Body(threshold=1e4)
    assert body.block(method_of(name, 0.5), body.situation(np.zeros(COUNT))) is None
    assert not body.trials


@pytest.mark.parametrize("name", METHODS)
def test_a_block_never_lowers_damage_and_ends_at_a_limit(name: str) -> None:
    body = Body()
    start = body.situation(np.array([0.2, 0.0, 1.0, 0.3, 0.1]))
    block = body.block(method_of(name, 0.3), start)
    assert block is not None and block.cycles > 0.0
    assert (block.damage >= start.damage).all() and block.damage.max() == 1.0
    assert (block.damage - start.damage).max() > 0.05


@pytest.mark.parametrize("name", METHODS)
def test_jumps_that_come_with_a_block_are_those_at_its_end(name: str) -> None:
    body = Body(most_coupled=2)
    block = body.block(method_of(name, 1.0), body.situation(np.zeros(COUNT)))
    assert block is not None
    assert (block.jump is None) == (name in ("euler", "exponential", "heun"))
    if block.jump is not None:
        there = body.jumps(block.damage)
        assert block.jump == pytest.approx(there, abs=2e-2 * np.abs(there).max())
