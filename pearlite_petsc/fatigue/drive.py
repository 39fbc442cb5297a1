"""What drives the damage of the interfaces: their stresses and their rates."""

from dataclasses import dataclass, replace

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.laws.damage import RateConstants


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """What drives the interfaces at the start of a block.

    Attributes:
        damage: D, below the failure damage; (k,).
        normal, shear: Effective stress ranges k_0 jump [MPa], 0 for interfaces that are broken; (k,).
        rates: Their rate constants.
        failure_damage: D at which an interface breaks.
        nominal: Whether the law takes (1 - D) times the effective stress.
        sensitivity: lambda (``exponential``) or g (``compliance``) of each; (k,), or None.
    """

    damage: FloatArray
    normal: FloatArray
    shear: FloatArray
    rates: RateConstants
    failure_damage: float
    nominal: bool
    sensitivity: FloatArray | None = None

    def of(self, chosen: IntArray) -> "Drive":
        """Return the drive of some interfaces as columns: arrays of shape (c, 1)."""
        rates = self.rates.columns(chosen)
        arrays = (self.damage, self.normal, self.shear)
        damage, normal, shear = (array[chosen, None] for array in arrays)
        sensitivity = None if self.sensitivity is None else self.sensitivity[chosen, None]
        return Drive(damage, normal, shear, rates, self.failure_damage, self.nominal, sensitivity)

    def with_sensitivity(self, sensitivity: FloatArray) -> "Drive":
        """Return the drive with lambda or g of each interface."""
        return replace(self, sensitivity=sensitivity)

    def rate_at(self, damage: FloatArray) -> FloatArray:
        """Return dD/dN [1/cycle] under the drive's effective stresses at another damage."""
        carried = 1.0 - damage if self.nominal else 1.0
        return self.rates.rate(self.normal * carried, self.shear * carried)

    def rate_along(self, damage: FloatArray, model: str) -> FloatArray:
        """Return dD/dN [1/cycle] by a rate model (``RateModel``) that starts at the drive's damage."""
        if model == "euler" or self.sensitivity is None:
            return self.rate_at(self.damage) + 0.0 * damage
        if model == "exponential":
            growth = np.exp(self.sensitivity * (damage - self.damage))
            return np.asarray(self.rate_at(self.damage) * growth)
        rise = (1.0 - self.sensitivity * self.damage) / (1.0 - self.sensitivity * damage)
        return replace(self, normal=self.normal * rise, shear=self.shear * rise).rate_at(damage)
