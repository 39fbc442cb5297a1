"""Cycle jump of the source: the rates of the block's start hold to its end."""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Situation
from pearlite_petsc.fatigue.extrapolation import Extrapolation


@dataclass(frozen=True, slots=True)
class Euler:
    """Rates stay as they are until an interface has gained ``delta_d`` or breaks.

    Attributes:
        delta_d: Largest increment of damage.
    """

    delta_d: float

    def __call__(self, start: Situation) -> Block | None:
        """Return the block, None where no interface has a rate."""
        ahead = Extrapolation(start.drive, self.delta_d, "euler", start.least)
        if not np.isfinite(ahead.longest):
            return None
        return Block(ahead.longest, ahead.damage_after(ahead.longest))
