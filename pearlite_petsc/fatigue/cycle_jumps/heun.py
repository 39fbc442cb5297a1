"""Cycle jump by Heun: the mean of the rates at the block's start and at its end."""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Situation, Trial, Trials
from pearlite_petsc.fatigue.extrapolation import Extrapolation, snapped

ALMOST_BROKEN = 0.999
"""Damage up to which interfaces go on trial, so that none breaks there."""


@dataclass(frozen=True, slots=True)
class Heun:
    """Repeats Euler's block with the mean of the rates at its start and its end.

    Attributes:
        delta_d: Largest increment of damage.
    """

    delta_d: float

    def __call__(self, start: Situation) -> Trials:
        """Try Euler's block and return the one with the mean rates."""
        ahead = Extrapolation(start.drive, self.delta_d, "euler", start.least)
        if not np.isfinite(ahead.longest):
            return None
        intact = start.damage < 1.0
        trial = np.minimum(ahead.damage_after(ahead.longest), ALMOST_BROKEN)
        trial = np.where(intact, trial, 1.0)
        jump = yield Trial(ahead.longest, trial)
        mean = 0.5 * (ahead.rate + start.drive_at(trial, jump).rate_at(trial)) * intact
        room = start.failure_damage - start.damage
        straight = np.divide(room, mean, where=mean > 0.0, out=np.full(len(mean), np.inf))
        cycles = min(ahead.longest, start.least(float(straight.min(initial=np.inf))))
        return Block(cycles, snapped(start.damage + mean * cycles, start.failure_damage))
