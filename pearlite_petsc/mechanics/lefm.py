"""Linear elastic fracture mechanics: handbook factors, near-tip stress, validity limits."""

import math

import numpy as np

from pearlite_petsc.arrays import FloatArray

TIP_FACTOR = math.sqrt(2.0 / math.pi)
"""b: mean normal stress over a length l ahead of the tip is b K/sqrt(l)."""


def edge_crack_factor(ratio: float) -> float:
    """Return F of a single edge crack, K = F sigma sqrt(pi a) (Tada, Paris, Irwin; 0.5 %).

    Args:
        ratio: a/W, 0 < a/W < 1.

    >>> round(edge_crack_factor(0.3), 3)
    1.655
    """
    half = 0.5 * math.pi * ratio
    shape = 0.752 + 2.02 * ratio + 0.37 * (1.0 - math.sin(half)) ** 3
    return math.sqrt(math.tan(half) / half) * shape / math.cos(half)


def centre_crack_factor(ratio: float) -> float:
    """Return F of a centre crack of length 2a in width 2W, K = F sigma sqrt(pi a) (Tada; 0.1 %).

    Args:
        ratio: a/W, 0 < a/W < 1.
    """
    return (1.0 - 0.025 * ratio**2 + 0.06 * ratio**4) / math.sqrt(math.cos(0.5 * math.pi * ratio))


def remote_stress(k: float, crack_length: float, width: float) -> float:
    """Return the stress [MPa] that gives K [MPa sqrt(um)] at an edge crack [um] in a window [um].

    >>> round(remote_stress(18e3, crack_length=80.0, width=200.0), 1)
    538.6
    """
    return k / (edge_crack_factor(crack_length / width) * math.sqrt(math.pi * crack_length))


def reversed_plastic_zone(delta_k: float, yield_stress: float) -> float:
    """Return (Delta-K/(2 sigma_yield))^2/pi [um] from MPa sqrt(um) and MPa.

    >>> round(reversed_plastic_zone(18e3, 470.0), 1)
    116.7
    """
    return (delta_k / (2.0 * yield_stress)) ** 2 / math.pi


def tip_stress(k: float, length: FloatArray) -> FloatArray:
    """Return the mean normal stress b K/sqrt(l) [MPa] over lengths l [um] ahead of a tip."""
    return np.asarray(TIP_FACTOR * k / np.sqrt(length))
