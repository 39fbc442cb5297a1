"""Nuclei in mirrored pairs along the wake of a crack, in place of those of the microstructure."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.spatial import cKDTree

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.tessellation.wake import SpacingAt, Wake, wake_lines

_CLEAR = 0.7
"""Nuclei closer than this to those of a line are left out, in the spacing of the nuclei there."""

_EMPTY = 0.9
# No place is further from a nucleus of the fine lattice, in lengths of elements: the vertices of
# elements that stay keep their place if nothing comes nearer.


@dataclass(frozen=True, slots=True, eq=False)
class WakeNuclei:
    """Nuclei along the lines of a wake.

    Attributes:
        lines: Those [um]; (p, 2) each.
        points: Nuclei [um]; (m, 2).
        spacing: Of the nuclei at each [um]; (m,).
    """

    lines: list[FloatArray]
    points: FloatArray
    spacing: FloatArray

    def spoiled_by(self, points: FloatArray) -> BoolArray:
        """Return which of other nuclei (n, 2) [um] would spoil the facets on the lines; (n,)."""
        close = np.zeros(len(points), dtype=np.bool_)
        if len(self.points):
            found = cKDTree(points).query_ball_point(self.points, _CLEAR * self.spacing)
            close[np.concatenate([np.asarray(rows, dtype=np.int64) for rows in found])] = True
        return close


def wake_nuclei(wake: Wake, spacing_at: SpacingAt, others: FloatArray, length: float) -> WakeNuclei:
    """Return nuclei in mirrored pairs along the lines of a wake.

    Args:
        wake: The wake.
        spacing_at: Spacing of the nuclei.
        others: Nuclei that no pair may come close to [um]; (n, 2).
        length: Of the fine elements [um].
    """
    lines = wake_lines(wake, spacing_at)
    taken = cKDTree(others)
    vertices = cKDTree(wake.fixed) if len(wake.fixed) else None
    points, spacings = np.empty((0, 2)), np.empty(0)
    for line in lines:
        pairs, size = _pairs_along(line, spacing_at)
        both = pairs.reshape(-1, 2)
        free = taken.query(both)[0] > _CLEAR * np.repeat(size, 2)
        if vertices is not None:
            free &= vertices.query(both)[0] > _EMPTY * length
        if len(points):
            free &= cKDTree(points).query(both)[0] > _CLEAR * np.repeat(size, 2)
        chosen = free.reshape(-1, 2).all(axis=1)
        points = np.concatenate([points, pairs[chosen].reshape(-1, 2)])
        spacings = np.concatenate([spacings, np.repeat(size[chosen], 2)])
    return WakeNuclei(lines, points, spacings)


def _pairs_along(line: FloatArray, spacing_at: SpacingAt) -> tuple[FloatArray, FloatArray]:
    """Return pairs on both sides of a line and the spacing at each pair; (m, 2, 2), (m,)."""
    pairs, sizes = [np.empty((0, 2, 2))], [np.empty(0)]
    for start, end in pairwise(line):
        way = end - start
        extent = float(np.hypot(*way))
        if extent == 0.0:
            continue
        direction = way / extent
        fine = np.linspace(0.0, extent, max(2, int(np.ceil(extent))) + 1)
        size = spacing_at(start + fine[:, None] * direction)
        steps = 0.5 * (1.0 / size[1:] + 1.0 / size[:-1]) * np.diff(fine)
        number = np.concatenate([[0.0], np.cumsum(steps)])
        count = max(1, round(float(number[-1])))
        along = np.interp((np.arange(count) + 0.5) * number[-1] / count, number, fine)
        middle = start + along[:, None] * direction
        own = np.interp(along, fine, size)
        across = 0.5 * own[:, None] * np.array([-direction[1], direction[0]])
        pairs.append(np.stack([middle + across, middle - across], axis=1))
        sizes.append(own)
    return np.concatenate(pairs), np.concatenate(sizes)
