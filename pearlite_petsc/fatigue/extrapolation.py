"""Damage of each interface for itself, extrapolated from the stresses at the start of a block.

A block ends when one interface has gained the largest increment allowed, or exactly when the
first one breaks. Within it each interface follows a rate model:

``euler``        the rate of the block's start (the source);
``exponential``  rate_0 exp(lambda (D - D_0)), lambda from the interface's last two rates;
``compliance``   the stress of a spring that softens in an elastic body,
                 sigma_0 (1 - g D_0)/(1 - g D), exact for one interface alone; g is its stiffness
                 ratio. It tells which interfaces will soften in a block; how they do,
                 ``softening`` works out together.
"""

from collections.abc import Callable
from typing import Literal

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.fatigue.release import next_release

RateModel = Literal["euler", "exponential", "compliance"]

BREAK_TOLERANCE = 1e-6
"""An interface closer than this to its failure damage is broken."""

NEVER = 1e250
"""Cycles after which nothing is taken to come."""

_NODES = 33
_PASSIVE = 1e-3


class Extrapolation:
    """A block of cycles in which each interface goes its own way.

    Args:
        drive: Damage, stresses and law at the start.
        delta_d: Largest increment of damage, or of released force with ``compliance``, whose steps
            to failure are equal; 0 < delta_d <= 1.
        model: Rate within the block.
        least: Least of a number over all who hold some of the interfaces; called equally often by
            each.

    Attributes:
        rate: dD/dN at the start [1/cycle]; (k,).
        longest: Cycles until the first interface of all reaches its limit; infinite where none has
            a rate.
        first: Number of that interface where it is among these; (0,) or (1,).
    """

    def __init__(
        self,
        drive: Drive,
        delta_d: float,
        model: RateModel,
        least: Callable[[float], float] = float,
    ) -> None:
        self.drive = drive
        self.rate = rate = drive.rate_at(drive.damage)
        if model == "compliance":
            ratio = 0.0 * drive.damage if drive.sensitivity is None else drive.sensitivity
            limit = next_release(drive.damage, ratio, drive.failure_damage, delta_d)
        else:
            limit = np.minimum(drive.damage + delta_d, drive.failure_damage)
        with np.errstate(divide="ignore"):
            straight = np.divide(
                limit - drive.damage, rate, where=rate > 0.0, out=np.full(len(rate), np.inf)
            )
        # An interface that two ranks hold must fare the same on both: none decides alone.
        self.longest = least(float(straight.min(initial=np.inf)))
        self.first = np.flatnonzero(straight == self.longest)[:1]
        self._leading = np.empty(0, dtype=np.int64)
        if model == "euler" or not np.isfinite(self.longest):
            return
        # Rates mostly grow with the damage; far below the leading interface they stay as they are.
        self._leading = np.flatnonzero(
            (rate * self.longest > _PASSIVE) | (straight <= self.longest)
        )
        path = drive.of(self._leading)
        grading = np.linspace(0.0, 1.0, _NODES) ** 2
        self._grid = path.damage + (limit[self._leading, None] - path.damage) * grading
        with np.errstate(divide="ignore"):
            slowness = np.minimum(1.0 / path.rate_along(self._grid, model), 1e6 * NEVER)
        mean = 0.5 * (slowness[:, 1:] + slowness[:, :-1]) * np.diff(self._grid)
        self._spent = np.zeros_like(self._grid)
        np.cumsum(mean, axis=1, out=self._spent[:, 1:])
        self.longest = least(float(self._spent[:, -1].min(initial=np.inf)))
        self.first = self._leading[self._spent[:, -1] == self.longest][:1]
        if self.longest > NEVER:
            self.longest = np.inf

    def damage_after(self, cycles: float) -> FloatArray:
        """Return D after 0 <= cycles <= longest, exactly 1 where an interface broke; (k,)."""
        drive = self.drive
        damage = drive.damage + self.rate * cycles
        leading = self._leading
        if len(leading):
            damage[leading] = _lookup(self._spent, self._grid, np.full(len(leading), cycles))
        return snapped(damage, drive.failure_damage)


def snapped(damage: FloatArray, failure_damage: float) -> FloatArray:
    """Return the damage with 1 where the failure damage is reached; (k,).

    >>> snapped(np.array([0.2, 0.7, 0.9]), failure_damage=0.7).tolist()
    [0.2, 1.0, 1.0]
    """
    return np.where(damage >= failure_damage - BREAK_TOLERANCE, 1.0, damage)


def _lookup(x: FloatArray, y: FloatArray, at: FloatArray) -> FloatArray:
    """Return y at one x of each row of a table with ascending x; x, y (r, m), at (r,)."""
    rows = np.arange(len(x))
    right = np.clip((x < at[:, None]).sum(axis=1), 1, x.shape[1] - 1)
    left = right - 1
    weight = (at - x[rows, left]) / (x[rows, right] - x[rows, left])
    return np.asarray(y[rows, left] + weight * (y[rows, right] - y[rows, left]))
