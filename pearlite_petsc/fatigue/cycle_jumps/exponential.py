"""Cycle jump whose rates grow exponentially with the damage, as they did in the blocks before."""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Memory, Situation
from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.fatigue.extrapolation import Extrapolation

UNKNOWN_EXPONENT = 3.0
"""lambda of an interface that has no history yet."""


@dataclass(frozen=True, slots=True)
class Exponential:
    """dD/dN = rate_0 exp(lambda (D - D_0)), lambda from the interface's last two rates.

    Attributes:
        delta_d: Largest increment of damage.
    """

    delta_d: float

    def __call__(self, start: Situation) -> Block | None:
        """Return the block, None where no interface has a rate."""
        drive, memory = _learned(start.drive, start.memory)
        ahead = Extrapolation(drive, self.delta_d, "exponential", start.least)
        if not np.isfinite(ahead.longest):
            return None
        return Block(ahead.longest, ahead.damage_after(ahead.longest), memory=memory)


def _learned(drive: Drive, memory: Memory) -> tuple[Drive, Memory]:
    """Return the drive with lambda of each interface, and what is to be remembered."""
    unknown = np.full(len(drive.damage), np.nan)
    damage, rate, known = (
        memory.by_interface.get(name, unknown) for name in ("damage", "rate", "exponent")
    )
    rate_now = drive.rate_at(drive.damage)
    found = exponent(rate_now, rate, drive.damage, damage)
    found = np.where(np.isnan(found), known, found)
    found = np.where(np.isnan(found), UNKNOWN_EXPONENT, found)
    now = {"damage": drive.damage, "rate": rate_now, "exponent": found}
    return drive.with_sensitivity(found), Memory(now)


def exponent(
    rate: FloatArray, before: FloatArray, damage: FloatArray, damage_before: FloatArray
) -> FloatArray:
    """Return lambda from two rates, NaN where the damage hardly moved; shape (k,).

    Args:
        rate, before: dD/dN now and before [1/cycle]; (k,).
        damage, damage_before: D then, NaN where nothing is known; (k,).

    >>> rate = np.array([1.0, np.e])
    >>> exponent(rate, np.ones(2), np.array([0.2, 0.5]), np.array([0.2, 0.25])).round(9).tolist()
    [nan, 4.0]
    """
    step = damage - damage_before
    known = (step > 0.01) & (before > 0.0) & (rate > 0.0)
    result = np.full(len(rate), np.nan)
    result[known] = np.log(rate[known] / before[known]) / step[known]
    return np.clip(result, -20.0, 20.0)
