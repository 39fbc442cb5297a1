"""Measured over computed rates that look like a slip: points far from the others, and units."""

import math
from collections.abc import Sequence

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray

FAR = 10.0
"""Factor from the median within which a ratio is scatter: single cracks differ by 2 to 3."""

DEVIATIONS = 3.5
"""Robust standard deviations from the median beyond which a value is an outlier, after Iglewicz
and Hoaglin, How to Detect and Handle Outliers (1993)."""

RATE_UNITS = {1e3: "mm/cycle", 1e6: "um/cycle", 1e9: "nm/cycle"}
"""How many times too large a rate in m/cycle is if it was written in these units."""

UNIT_WITHIN = 5.0
"""How far C of another steel may be off beside a unit."""

DELTA_K_UNITS = {math.sqrt(1e3): "MPa sqrt(mm)", 1e3: "MPa sqrt(um)"}
"""The same for Delta-K in MPa sqrt(m)."""


def outliers(ratios: Sequence[float]) -> IntArray:
    """Return the places of ratios far from the others; shape (o,).

    A ratio is far if its logarithm is off the median by more than ``DEVIATIONS`` median absolute
    deviations (scaled to a standard deviation) and by more than a factor of ``FAR``. Two ratios
    cannot tell which of them is wrong.

    >>> outliers([2.0, 2.5, 1.8, 2e-5])
    array([3])
    """
    logs = np.log(np.asarray(ratios, dtype=float))
    if len(logs) < 3:
        return np.empty(0, dtype=np.int64)
    off = np.abs(logs - np.median(logs))
    limit = max(math.log(FAR), DEVIATIONS * 1.4826 * float(np.median(off)))
    return np.flatnonzero(off > limit)


def rate_unit(factor: float) -> str | None:
    """Return the unit that a common factor of all rates speaks for, None for none.

    >>> rate_unit(352.0), rate_unit(8.0)
    ('mm/cycle', None)
    """
    for size, unit in RATE_UNITS.items():
        if size / UNIT_WITHIN <= factor <= size * UNIT_WITHIN:
            return unit
    return None


def delta_k_unit(delta_k: Sequence[float], computed: FloatArray) -> str | None:
    """Return the unit in which every Delta-K would be a computed one, None if one fits as it is.

    Args:
        delta_k: Measured [MPa sqrt(m)]; shape (n,).
        computed: Delta-K of the computed curve, rising [MPa sqrt(m)]; shape (k,).
    """
    values = np.asarray(delta_k, dtype=float)
    # One computed Delta-K is no range; a test is seldom at exactly that one.
    low, high = 0.5 * computed[0], 1.5 * computed[-1]
    if not len(values) or (values <= high).any():
        return None
    for size, unit in DELTA_K_UNITS.items():
        if ((values / size >= low) & (values / size <= high)).all():
            return unit
    return None
