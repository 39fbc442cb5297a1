"""Damage laws as plug-ins: what they are given of the interfaces, and what they return."""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray, guarded
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.laws.law import Law, called, described


@dataclass(frozen=True, slots=True, eq=False)
class DamageInterfaces:
    """Interfaces as a damage law sees them at the start of a block of cycles.

    Attributes:
        length: Length L [um], > 0; (k,).
        kind: ``Kind`` of each interface; (k,).
        strength: S, the yield stress, or cementite's strength where lamellae are cut [MPa]; (k,).
        midpoint: Midpoint [um]; (k, 2).
        normal: Unit normal from element i to j; (k, 2).
        crack_distance: Distance of the midpoint from the nearest broken interface or the notch
            [um], 0 on it; NaN for a law that does not follow the crack; (k,).
        delta_k_th: Delta-K_th of the state [MPa sqrt(um)].
        remote_threshold: Remote stress at Delta-K_th [MPa].
    """

    length: FloatArray
    kind: IntArray
    strength: FloatArray
    midpoint: FloatArray
    normal: FloatArray
    crack_distance: FloatArray
    delta_k_th: float
    remote_threshold: float

    def __post_init__(self) -> None:
        for entry in fields(self):
            values = getattr(self, entry.name)
            if isinstance(values, np.ndarray):
                # A law that changed them would change the mesh.
                object.__setattr__(self, entry.name, guarded(values))


def cubic_rate(stress: FloatArray, threshold: FloatArray, factor: FloatArray) -> FloatArray:
    """Return factor <stress - threshold>^3 [1/cycle], Eq. (28)-(31); shape (k,)."""
    over = np.maximum(stress - threshold, 0.0)
    # numpy's power of 3 takes eight times as long.
    return np.asarray(factor * (over * over * over))


ComponentRate = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
"""A function (stress range [MPa], threshold [MPa], factor) -> rate [1/cycle] of shapes that broadcast."""


@dataclass(frozen=True, slots=True, eq=False)
class RateConstants:
    """Constants of the damage rate dD/dN = sqrt(r(normal)^2 + beta r(shear)^2), Eq. (32).

    Attributes:
        factor: Factor of the rate r of a stress component; C/(S L) [1/(cycle MPa^3)] for the
            cubic rate; (k,).
        threshold: Stress range below which no damage grows [MPa]; (k,).
        beta: Weight of the shear rate [-].
        component_rate: The function r of stress, threshold and factor, entry by entry: 0 up to
            the threshold, and never falling with the stress.
    """

    factor: FloatArray
    threshold: FloatArray
    beta: float
    component_rate: ComponentRate = cubic_rate

    def rate(self, normal: FloatArray, shear: FloatArray) -> FloatArray:
        """Return dD/dN of each interface [1/cycle].

        Args:
            normal: Normal stress range, tension positive; compression does no damage [MPa]; (k,).
            shear: Shear stress range, of which the magnitude counts [MPa]; (k,).
        """
        rate_n = self.component_rate(normal, self.threshold, self.factor)
        rate_t = self.component_rate(np.abs(shear), self.threshold, self.factor)
        return np.asarray(np.sqrt(rate_n**2 + self.beta * rate_t**2))

    def columns(self, chosen: IntArray) -> "RateConstants":
        """Return the constants of some interfaces as columns: arrays of shape (c, 1)."""
        return replace(
            self, factor=self.factor[chosen, None], threshold=self.threshold[chosen, None]
        )

    def only(self, some: BoolArray) -> "RateConstants":
        """Return constants whose rate is 0 except for some interfaces; some has shape (k,)."""
        return replace(self, factor=self.factor * some)


@dataclass(frozen=True, slots=True, kw_only=True)
class DamageLaw(Law):
    """A damage law: ``function(interfaces, damage, *, parameters...) -> RateConstants``.

    The function gets ``DamageInterfaces`` and the scene's ``Damage`` table, and may change
    neither.

    Attributes:
        follows_crack: Whether the law depends on ``crack_distance``; it is then called again
            whenever interfaces have broken, otherwise once per mesh.

    Examples:
        >>> def half_rate(interfaces, damage):
        ...     factor = 0.5 * damage.c / (interfaces.strength * interfaces.length)
        ...     return RateConstants(factor, 0.0 * factor, damage.beta)
        >>> DamageLaw(name="half_rate", help="half of Eq. (28)", function=half_rate).table
        'damage'
    """

    follows_crack: bool = False

    table: ClassVar[str] = "damage"
    key: ClassVar[str] = "law"
    arguments: ClassVar[tuple[str, ...]] = ("interfaces", "damage")

    def rate_constants(self, interfaces: DamageInterfaces, damage: Any) -> RateConstants:
        """Return the constants of each interface.

        Args:
            interfaces: k interfaces.
            damage: The scene's table.

        Raises:
            PearliteError: The function failed, or what it returned cannot be the constants of k
                interfaces: it has the wrong shape, is negative or is not finite.
        """
        found = called(self, interfaces, damage)
        if not isinstance(found, RateConstants):
            kind = type(found).__name__
            raise PearliteError(f"{described(self)} returns {kind}, not RateConstants")
        for name in ("factor", "threshold"):
            values = np.asarray(getattr(found, name))
            if values.shape != interfaces.length.shape:
                shapes = f"shape {values.shape}, not {interfaces.length.shape}"
                raise PearliteError(f"{described(self)}: {name} has {shapes}")
            wrong = np.flatnonzero(~(np.isfinite(values) & (values >= 0.0)))
            if len(wrong):
                first = f"interface {wrong[0]}: {name} {values[wrong[0]]:g}"
                raise PearliteError(f"{described(self)}: {first} is not finite and at least 0")
        if not (np.isfinite(found.beta) and found.beta >= 0.0):
            raise PearliteError(f"{described(self)}: beta {found.beta:g} is not at least 0")
        return found
