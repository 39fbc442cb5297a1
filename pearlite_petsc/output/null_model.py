"""The model without a microstructure: only yield stress and threshold differ between states."""

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.damage import straight_crack_factor
from pearlite_petsc.scene import State


def null_rate(delta_k: FloatArray, state: State) -> FloatArray:
    """Return f (Delta-K - Delta-K_th)^3/sigma_yield, 0 below the threshold.

    That is what the damage law ``objective`` gives for one straight crack in a homogeneous body, up
    to C (b/sqrt(l_ref))^3; f is ``straight_crack_factor``, 3 to 7 by Delta-K_th/Delta-K.

    Args:
        delta_k: [MPa sqrt(um)]; shape (n,).
        state: Threshold and yield stress.
    """
    factor = straight_crack_factor(state.delta_k_th / delta_k)
    over = np.maximum(delta_k - state.delta_k_th, 0.0)
    return np.asarray(factor * over**3 / state.yield_stress)


def null_ratio(delta_k: FloatArray, state: State, other: State) -> FloatArray:
    """Return how many times faster one state grows than another with no microstructure; (n,).

    NaN where the other one does not grow either way.
    """
    below = null_rate(delta_k, other)
    return np.asarray(null_rate(delta_k, state) / np.where(below > 0.0, below, np.nan))
