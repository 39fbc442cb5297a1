"""Jump in cycles: how damage grows within a block whose stresses are known at its start.

A block ends when one interface has gained the largest increment allowed, or exactly when the
first one breaks. Within it each interface follows a rate curve:

``euler``        the rate of the block's start (the source);
``exponential``  rate_0 exp(lambda (D - D_0)), lambda from the interface's last two rates;
``compliance``   the stress of a spring that softens in an elastic body,
                 sigma_0 (1 - g D_0)/(1 - g D), exact for one interface alone; g is the share of
                 the spring in the compliance seen at the interface. It tells which interfaces
                 will soften in a block; how they do, ``softening`` works out together.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, TypeVar

import numpy as np
from scipy.spatial.distance import cdist

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.damage import DamageLaw, damage_rate
from pearlite_petsc.scene import CycleJumpMethod

Real = TypeVar("Real", float, FloatArray)

RateCurve = Literal["euler", "exponential", "compliance"]

BREAK_TOLERANCE = 1e-6
"""An interface closer than this to its failure damage is broken."""

UNKNOWN_EXPONENT = 3.0
"""lambda of an interface that has no history yet."""

SURROUNDINGS = 0.32
"""Stiffness k_n L/E of what surrounds an interface, the mean of many measured."""

NEVER = 1e250
"""Cycles after which nothing is taken to come."""

_NODES = 33
_PASSIVE = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """What drives the interfaces at the start of a block.

    Attributes:
        damage: D, below the failure damage; (k,).
        normal, shear: Effective stress ranges k_0 jump [MPa], 0 for interfaces that are broken; (k,).
        law: Their damage law.
        failure_damage: D at which an interface breaks.
        nominal: Whether the law takes (1 - D) times the effective stress.
        sensitivity: lambda (``exponential``) or g (``compliance``) of each; (k,), or None.
    """

    damage: FloatArray
    normal: FloatArray
    shear: FloatArray
    law: DamageLaw
    failure_damage: float
    nominal: bool
    sensitivity: FloatArray | None = None

    def take(self, chosen: IntArray) -> "Drive":
        """Return the drive of some interfaces as columns: arrays of shape (c, 1)."""
        law = DamageLaw(
            self.law.factor[chosen, None], self.law.threshold[chosen, None], self.law.beta
        )
        arrays = (self.damage, self.normal, self.shear)
        damage, normal, shear = (array[chosen, None] for array in arrays)
        sensitivity = None if self.sensitivity is None else self.sensitivity[chosen, None]
        return Drive(damage, normal, shear, law, self.failure_damage, self.nominal, sensitivity)

    def with_sensitivity(self, sensitivity: FloatArray) -> "Drive":
        """Return the drive with lambda or g of each interface."""
        return replace(self, sensitivity=sensitivity)

    def rate_at(self, damage: FloatArray) -> FloatArray:
        """Return dD/dN [1/cycle] under the drive's effective stresses at another damage."""
        share = 1.0 - damage if self.nominal else 1.0
        return damage_rate(self.normal * share, self.shear * share, self.law)

    def rate_along(self, damage: FloatArray, curve: RateCurve) -> FloatArray:
        """Return dD/dN [1/cycle] along a curve that starts at the drive's damage."""
        if curve == "euler" or self.sensitivity is None:
            return self.rate_at(self.damage) + 0.0 * damage
        if curve == "exponential":
            growth = np.exp(self.sensitivity * (damage - self.damage))
            return np.asarray(self.rate_at(self.damage) * growth)
        share = (1.0 - self.sensitivity * self.damage) / (1.0 - self.sensitivity * damage)
        return replace(self, normal=self.normal * share, shear=self.shear * share).rate_at(damage)


class Block:
    """A block of cycles that starts from a drive.

    Args:
        drive: Damage, stresses and law at the start.
        delta_d: Largest increment of damage, or of released force with ``compliance``, whose steps
            to failure are equal; 0 < delta_d <= 1.
        curve: Rate within the block.
        least: Least of a number over all who hold a part of the interfaces; called equally often
            by each.

    Attributes:
        longest: Cycles until the first interface of all reaches its limit; infinite where none has
            a rate.
        first: Number of that interface where it is among these; (0,) or (1,).
    """

    def __init__(
        self,
        drive: Drive,
        delta_d: float,
        curve: RateCurve,
        least: Callable[[float], float] = float,
    ) -> None:
        self.drive = drive
        self.rate = rate = drive.rate_at(drive.damage)
        if curve == "compliance":
            limit = next_release(drive, delta_d)
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
        if curve == "euler" or not np.isfinite(self.longest):
            return
        # Rates mostly grow with the damage; far below the leading interface they stay as they are.
        self._leading = np.flatnonzero(
            (rate * self.longest > _PASSIVE) | (straight <= self.longest)
        )
        path = drive.take(self._leading)
        grading = np.linspace(0.0, 1.0, _NODES) ** 2
        self._grid = path.damage + (limit[self._leading, None] - path.damage) * grading
        with np.errstate(divide="ignore"):
            slowness = np.minimum(1.0 / path.rate_along(self._grid, curve), 1e6 * NEVER)
        mean = 0.5 * (slowness[:, 1:] + slowness[:, :-1]) * np.diff(self._grid)
        self._spent = np.zeros_like(self._grid)
        np.cumsum(mean, axis=1, out=self._spent[:, 1:])
        self.longest = least(float(self._spent[:, -1].min(initial=np.inf)))
        self.first = self._leading[self._spent[:, -1] == self.longest][:1]
        if self.longest > NEVER:
            self.longest = np.inf
            return

    def damage_after(self, cycles: float) -> FloatArray:
        """Return D after 0 <= cycles <= longest, exactly 1 where an interface broke; (k,)."""
        drive = self.drive
        damage = drive.damage + self.rate * cycles
        leading = self._leading
        if len(leading):
            damage[leading] = _lookup(self._spent, self._grid, np.full(len(leading), cycles))
        return snapped(damage, drive.failure_damage)


def own_share(stiffness: FloatArray) -> FloatArray:
    """Return g = k/(k + k_surroundings) of springs in series with what surrounds them; (k,)."""
    return np.asarray(stiffness / (stiffness + SURROUNDINGS))


def released(damage: Real, share: Real) -> Real:
    """Return the share of its force that a softening interface has let go, D (1-g)/(1 - g D)."""
    gone: Real = damage * (1.0 - share) / (1.0 - share * damage)
    return gone


def next_release(drive: Drive, step: float, least_steps: float = 1.0) -> FloatArray:
    """Return the damage at the end of equal steps in released force on the way to failure; (k,).

    Args:
        drive: Damage and g.
        step: Largest share of the force that a step may release.
        least_steps: Steps at least.
    """
    share = 0.0 * drive.damage if drive.sensitivity is None else drive.sensitivity
    start = released(drive.damage, share)
    end = released(np.full_like(start, drive.failure_damage), share)
    steps = np.maximum(np.ceil((end - start) / step - 1e-9), least_steps)
    force = start + (end - start) / steps
    return np.where(steps > 1.0, force / (1.0 - share + share * force), drive.failure_damage)


def _lookup(x: FloatArray, y: FloatArray, at: FloatArray) -> FloatArray:
    """Return y at one x of each row of a table with ascending x; x, y (r, m), at (r,)."""
    rows = np.arange(len(x))
    right = np.clip((x < at[:, None]).sum(axis=1), 1, x.shape[1] - 1)
    left = right - 1
    part = (at - x[rows, left]) / (x[rows, right] - x[rows, left])
    return np.asarray(y[rows, left] + part * (y[rows, right] - y[rows, left]))


def snapped(damage: FloatArray, failure_damage: float) -> FloatArray:
    """Return the damage with 1 where the failure damage is reached; (k,)."""
    return np.where(damage >= failure_damage - BREAK_TOLERANCE, 1.0, damage)


class Memory:
    """Remembers the last rate of each interface and learns lambda from the next (``exponential``).

    Args:
        method: The cycle jump of the scene.
        count: Interfaces.

    Attributes:
        sensitivity: lambda of each interface; (k,).
        damage, value: D, NaN where nothing is known, and dD/dN then; (k,).
    """

    def __init__(self, method: CycleJumpMethod, count: int) -> None:
        self.curve: RateCurve = "exponential" if method == "exponential" else "euler"
        self.sensitivity = np.full(count, UNKNOWN_EXPONENT)
        self.damage = np.full(count, np.nan)
        self.value = np.zeros(count)

    def learned(self, drive: Drive) -> Drive:
        """Return the drive with lambda of each interface, from its last two rates."""
        if self.curve == "euler":
            return drive
        rate = drive.rate_at(drive.damage)
        found = exponent(rate, self.value, drive.damage, self.damage)
        self.sensitivity = np.where(np.isnan(found), self.sensitivity, found)
        self.damage, self.value = drive.damage, rate
        return drive.with_sensitivity(self.sensitivity)

    def forget_near(self, midpoint: FloatArray, breaks: FloatArray, reach: float) -> None:
        """Forget what was learned close to interfaces that broke.

        Args:
            midpoint: Of all interfaces [um]; (k, 2).
            breaks: Midpoints of those that broke [um]; (b, 2).
            reach: How far a break changes stresses much [um].
        """
        if self.curve == "euler":
            return
        near = cdist(midpoint, breaks).min(axis=1) < reach
        self.damage = np.where(near, np.nan, self.damage)
        self.sensitivity = np.where(near, UNKNOWN_EXPONENT, self.sensitivity)


def exponent(
    rate: FloatArray, before: FloatArray, damage: FloatArray, damage_before: FloatArray
) -> FloatArray:
    """Return lambda from two rates, NaN where the damage hardly moved; shape (k,)."""
    step = damage - damage_before
    known = (step > 0.01) & (before > 0.0) & (rate > 0.0)
    result = np.full(len(rate), np.nan)
    result[known] = np.log(rate[known] / before[known]) / step[known]
    return np.clip(result, -20.0, 20.0)
