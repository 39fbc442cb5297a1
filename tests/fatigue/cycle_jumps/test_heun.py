import numpy as np
import pytest

from pearlite_petsc.fatigue.cycle_jumps.heun import Heun
from tests.fatigue.cycle_jumps.body import COUNT, Body


def test_no_intact_spring_is_broken_on_trial() -> None:
    body = Body()
    block = body.block(Heun(1.0), body.situation(np.array([0.0, 0.0, 1.0, 0.0, 0.9])))
    assert block is not None
    (trial,) = body.trials
    assert (trial.damage == 1.0).tolist() == [False, False, True, False, False]
    assert trial.damage.max(where=trial.damage < 1.0, initial=0.0) == 0.999


def test_damage_grows_by_the_mean_of_the_rates_at_both_ends() -> None:
    body = Body()
    start = body.situation(np.zeros(COUNT))
    block = body.block(Heun(0.1), start)
    assert block is not None
    (trial,) = body.trials
    here = start.drive.rate_at(start.damage)
    there = start.drive_at(trial.damage, body.jumps(trial.damage)).rate_at(trial.damage)
    assert block.damage == pytest.approx(0.5 * (here + there) * block.cycles, rel=1e-12)
    assert block.cycles == trial.cycles
