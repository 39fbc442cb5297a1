"""Damage of interfaces under cyclic stress, source Eq. (26)-(33)."""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.mechanics.lefm import TIP_FACTOR
from pearlite_petsc.scene import Damage, Kind, State


@dataclass(frozen=True, slots=True, eq=False)
class DamageLaw:
    """Rate of each interface: dD/dN = factor <stress - threshold>^3, per stress component.

    Attributes:
        factor: C/(S L) of the law, with (L/l_ref)^(3/2) for ``objective`` [1/(cycle MPa^3)]; (k,).
        threshold: Stress range below which nothing grows [MPa]; (k,).
        beta: Weight of the shear rate [-].
    """

    factor: FloatArray
    threshold: FloatArray
    beta: float


def yield_stress(shear_strain: float) -> float:
    """Return the yield stress of sheared R260 [MPa], Eq. (33): 616 at gamma 2, 1024 at 30.

    A power law through those two values; at gamma = 0 it gives 0 while the steel has 470, so the
    program takes the yield stress of each state as data.
    """
    exponent = np.log(1024.0 / 616.0) / np.log(15.0)
    return float(616.0 * (shear_strain / 2.0) ** exponent)


def strength(kind: IntArray, yield_strength: float, cementite_strength: float) -> FloatArray:
    """Return S of each interface [MPa]: cementite's where lamellae are cut, else the yield stress."""
    return np.where(kind == Kind.CEMENTITE, cementite_strength, yield_strength)


def damage_law(
    length: FloatArray, kind: IntArray, damage: Damage, state: State, remote_threshold: float
) -> DamageLaw:
    """Return the law of each interface.

    ``printed``: dD/dN = C/(S L) <dsigma - dsigma_th>^3, Eq. (28)-(31).
    ``objective``: dD/dN = C/(S l_ref^(3/2) L) <dsigma sqrt(L) - b Delta-K_th>^3, which gives
    da/dN = (C/S) (b/sqrt(l_ref))^3 (Delta-K - Delta-K_th)^3 at any element size.

    Args:
        length: Interface length L [um]; shape (k,).
        kind: Kind of each interface; shape (k,).
        damage: Constants.
        state: Yield stress and threshold of the state.
        remote_threshold: Remote stress at Delta-K_th [MPa], for the threshold ``remote``.
    """
    factor = damage.c / (strength(kind, state.yield_stress, damage.cementite_strength) * length)
    if damage.law == "objective":
        factor = factor * (length / damage.reference_length) ** 1.5
    if damage.threshold == "tip":
        threshold = TIP_FACTOR * state.delta_k_th / np.sqrt(length)
    else:
        threshold = np.full(len(length), remote_threshold)
    return DamageLaw(factor, threshold, damage.beta)


def component_rate(stress: FloatArray, threshold: FloatArray, factor: FloatArray) -> FloatArray:
    """Return factor <stress - threshold>^3 [1/cycle], Eq. (28)-(31); shape (k,)."""
    over = np.maximum(stress - threshold, 0.0)
    # numpy's power of 3 takes eight times as long.
    return np.asarray(factor * (over * over * over))


def damage_rate(normal: FloatArray, shear: FloatArray, law: DamageLaw) -> FloatArray:
    """Return dD/dN of each interface, Eq. (32): sqrt(rate_n^2 + beta rate_t^2).

    Args:
        normal: Normal stress range, tension positive; compression does no damage [MPa]; (k,).
        shear: Shear stress range, its magnitude counts [MPa]; (k,).
        law: Law of the interfaces.

    Returns:
        [1/cycle]; shape (k,).
    """
    rate_n = component_rate(normal, law.threshold, law.factor)
    rate_t = component_rate(np.abs(shear), law.threshold, law.factor)
    return np.asarray(np.sqrt(rate_n**2 + law.beta * rate_t**2))
