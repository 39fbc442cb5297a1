"""Hilbert's space-filling curve: neighbours in the plane get near numbers."""

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray

_BITS = 16


def hilbert_order(points: FloatArray) -> IntArray:
    """Return the order of points [um] along a Hilbert curve through their bounding square; (n,).

    >>> hilbert_order(np.array([[0.0, 0.0], [9.0, 9.0], [1.0, 1.0], [9.0, 8.0]]))
    array([0, 2, 1, 3])
    """
    if not len(points):
        return np.empty(0, dtype=np.int64)
    low = points.min(axis=0)
    extent = float((points.max(axis=0) - low).max()) or 1.0
    cell = np.minimum((points - low) / extent * 2**_BITS, 2**_BITS - 1).astype(np.int64)
    x, y = cell[:, 0], cell[:, 1]
    key = np.zeros(len(points), dtype=np.int64)
    for bit in range(_BITS - 1, -1, -1):
        side = 1 << bit
        right = (x & side) > 0
        top = (y & side) > 0
        key = 4 * key + np.where(right, np.where(top, 2, 3), np.where(top, 1, 0))
        # Turn the quadrant so that its own curve starts where the previous one ended.
        flip = ~top & right
        x = np.where(flip, side - 1 - (x & (side - 1)), x & (side - 1))
        y = np.where(flip, side - 1 - (y & (side - 1)), y & (side - 1))
        x, y = np.where(top, x, y), np.where(top, y, x)
    return np.argsort(key, kind="stable").astype(np.int64)
