"""Hard-core random points: random, but nowhere closer than a distance."""

import numpy as np
from scipy.spatial import cKDTree

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray


def independent_subset(pairs: IntArray, priority: FloatArray) -> BoolArray:
    """Choose things in order of priority, leaving out all that conflict with one chosen before.

    The result is that of the sequential greedy choice, found in a few rounds over whole arrays.

    Args:
        pairs: Conflicting things; (p, 2).
        priority: Smaller goes first, all different; (n,).

    Returns:
        Whether a thing is chosen; (n,). No two chosen conflict, and every other one conflicts
        with a chosen one.
    """
    swap = priority[pairs[:, 0]] > priority[pairs[:, 1]]
    first = np.where(swap, pairs[:, 1], pairs[:, 0])
    second = np.where(swap, pairs[:, 0], pairs[:, 1])
    undecided = np.ones(len(priority), dtype=np.bool_)
    chosen = np.zeros(len(priority), dtype=np.bool_)
    while len(first):
        winner = undecided.copy()
        winner[second] = False
        chosen |= winner
        undecided &= ~winner
        undecided[second[winner[first]]] = False
        open_pair = undecided[first] & undecided[second]
        first, second = first[open_pair], second[open_pair]
    return chosen | undecided


def conflicting_pairs(points: FloatArray, distance: float) -> IntArray:
    """Return all pairs of points [um] closer than a distance [um]; points (n, 2), pairs (p, 2)."""
    if len(points) < 2:
        return np.empty((0, 2), dtype=np.int64)
    pairs = cKDTree(points).query_pairs(distance, output_type="ndarray")
    return np.asarray(pairs, dtype=np.int64).reshape(-1, 2)


def hard_core_points(
    box: tuple[float, float, float, float],
    mapping: FloatArray,
    intensity: float,
    distance: float,
    rng: np.random.Generator,
) -> FloatArray:
    """Thin a Poisson process so that no two points are closer than a distance (Matern's third).

    Args:
        box: x0, y0, x1, y1 [um].
        mapping: Linear map of determinant 1 from the box to the region of the points; (2, 2).
        intensity: Of the process before thinning [1/um^2].
        distance: Hard-core distance [um].
        rng: Stream of random numbers.

    Returns:
        Points in the mapped box [um]; (n, 2), at least one.
    """
    x0, y0, x1, y1 = box
    count = max(1, int(rng.poisson(intensity * (x1 - x0) * (y1 - y0))))
    points = np.array([x0, y0]) + rng.random((count, 2)) * np.array([x1 - x0, y1 - y0])
    points = points @ mapping.T
    priority = np.arange(count, dtype=np.float64)
    kept = independent_subset(conflicting_pairs(points, distance), priority)
    return np.asarray(points[kept])
