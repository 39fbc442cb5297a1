"""Coarsening levels: nested subsets of the nuclei, each sparser by sqrt(2) than the one before."""

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.microstructure.hard_core import conflicting_pairs, independent_subset

GROWTH = float(np.sqrt(2.0))
"""Ratio of the spacings of one level and the next."""

_PACKING = 0.72
# Random packing at a distance r leaves a mean spacing of about r/0.72.


def coarsening_levels(
    points: FloatArray,
    partner: IntArray,
    priority: FloatArray,
    spacing: float,
    coarsest: float,
) -> IntArray:
    """Return the last level at which each nucleus is still there.

    The nuclei with level >= l have a spacing of about ``spacing * GROWTH**l`` and never move, so
    a graded mesh is a choice among the nuclei of the fine one.

    Args:
        points: Nuclei [um]; (n, 2).
        partner: Mirror image across the notch, -1 for none; both halves get one level; (n,).
        priority: Smaller is kept longer, equal in a pair; (n,).
        spacing: Mean spacing of the fine nuclei [um].
        coarsest: Largest spacing, in multiples of ``spacing``.

    Returns:
        Level, 0 for those that are there only at full resolution; (n,).
    """
    level = np.zeros(len(points), dtype=np.int64)
    number = np.arange(len(points))
    item = np.where(partner >= 0, np.minimum(number, partner), number)
    current = number
    for step in range(1, level_of(np.array([coarsest]), coarsest)[0] + 1):
        pairs = conflicting_pairs(points[current], _PACKING * spacing * GROWTH**step)
        items = item[current][pairs]
        items = items[items[:, 0] != items[:, 1]]
        present, local = np.unique(item[current], return_inverse=True)
        places = np.searchsorted(present, items)
        chosen = independent_subset(places, priority[present])
        current = current[chosen[local]]
        level[current] = step
    return level


def level_of(factor: FloatArray, coarsest: float) -> IntArray:
    """Return the highest level whose spacing is at most ``factor`` times the fine one; (n,).

    >>> level_of(np.array([1.0, 1.5, 2.0, 100.0]), coarsest=8.0)
    array([0, 1, 2, 6])
    """
    capped = np.clip(factor, 1.0, max(coarsest, 1.0))
    # The tolerance keeps exact powers of sqrt(2) on their own level.
    return np.asarray(np.floor(np.log(capped) / np.log(GROWTH) + 1e-9), dtype=np.int64)
