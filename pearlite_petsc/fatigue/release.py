"""How the force of an interface falls as it softens in the elastic body round it.

An interface is a spring in series with its surroundings. With g = k/(k + k_surroundings), its
stiffness ratio, the force at a damage D is (1 - D)/(1 - g D) of that of the intact interface.
"""

from typing import TypeVar

import numpy as np

from pearlite_petsc.arrays import FloatArray

Real = TypeVar("Real", float, FloatArray)

SURROUNDINGS = 0.32
"""Stiffness k_n L/E of what surrounds an interface, the mean of many measured."""


def stiffness_ratio(stiffness: FloatArray) -> FloatArray:
    """Return g = k/(k + k_surroundings) of springs in series with what surrounds them; (k,).

    Args:
        stiffness: k_n L/E of each; (k,).

    >>> stiffness_ratio(np.array([0.0, 0.32, 0.96]))
    array([0.  , 0.5 , 0.75])
    """
    return np.asarray(stiffness / (stiffness + SURROUNDINGS))


def released(damage: Real, stiffness_ratio: Real) -> Real:
    """Return the fraction of its force that a softening interface has let go, D (1-g)/(1 - g D).

    >>> released(0.5, 0.0), released(0.5, 0.5), released(1.0, 0.5)
    (0.5, 0.3333333333333333, 1.0)
    """
    gone: Real = damage * (1.0 - stiffness_ratio) / (1.0 - stiffness_ratio * damage)
    return gone


def next_release(
    damage: FloatArray,
    stiffness_ratio: FloatArray,
    failure_damage: float,
    step: float,
    least_steps: float = 1.0,
) -> FloatArray:
    """Return the damage at the end of equal steps in released force on the way to failure; (k,).

    Args:
        damage: D; (k,).
        stiffness_ratio: g of each; (k,).
        failure_damage: D at which an interface breaks.
        step: Largest fraction of the force that a step may release.
        least_steps: Steps at least.
    """
    g = stiffness_ratio
    start = released(damage, g)
    end = released(np.full_like(start, failure_damage), g)
    steps = np.maximum(np.ceil((end - start) / step - 1e-9), least_steps)
    force = start + (end - start) / steps
    return np.where(steps > 1.0, force / (1.0 - g + g * force), failure_damage)
