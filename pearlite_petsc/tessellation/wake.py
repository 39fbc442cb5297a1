"""The wake: the crack far behind its tip, as lines that large elements follow.

What lies far behind the tip acts on it through its opening alone. There the crack is a polyline as
close to the true one as the elements are fine, nuclei in mirrored pairs along it give facets on it,
and the nuclei of the microstructure that would spoil them are left out.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from pearlite_petsc.arrays import FloatArray, IntArray

STAYING = 1.5
"""Radius of the discs that stay fine in the wake, in lengths of elements."""

STEEPER = 2.5
"""How much faster elements coarsen round those than round the fine zone."""

TOLERANCE = 0.25
"""Largest distance of a line from the crack, in the spacing of the nuclei there."""

SpacingAt = Callable[[FloatArray], FloatArray]
"""Points (n, 2) [um] to the spacing of the nuclei there [um]; (n,)."""


@dataclass(frozen=True, slots=True, eq=False)
class Wake:
    """What is known of the crack where its elements have gone.

    Attributes:
        points, offsets: Run i of the crack is points[offsets[i]:offsets[i + 1]] [um]; (p, 2), (r + 1,).
        stay: Centres of discs in which the elements stay fine [um]; (q, 2).
        fixed: Vertices of elements that stay [um]; (f, 2).
        pairs: Nuclei on both sides of the broken interfaces that the runs stand for; (b, 2).
    """

    points: FloatArray
    offsets: IntArray
    stay: FloatArray
    fixed: FloatArray
    pairs: IntArray

    @property
    def runs(self) -> list[FloatArray]:
        """Polylines [um]; (p, 2) each."""
        return np.split(self.points, self.offsets[1:-1]) if len(self.offsets) > 1 else []

    def distance_from_staying(self, points: FloatArray, length: float) -> FloatArray:
        """Return how far points lie from what stays fine [um], infinite where nothing does; (n,).

        Args:
            points: [um]; (n, 2).
            length: Of the elements [um].
        """
        if not len(self.stay):
            return np.full(len(points), np.inf)
        gap = cKDTree(self.stay).query(points)[0]
        return np.asarray(np.maximum(gap - STAYING * length, 0.0))


def wake_of(runs: list[FloatArray], stay: FloatArray) -> Wake:
    """Return the wake of some runs (p, 2) each, of no broken interface yet [um].

    >>> run = np.array([[0.0, 0.0], [9.0, 1.0]])
    >>> [len(points) for points in wake_of([run, run[:1]], np.empty((0, 2))).runs]
    [2, 1]
    """
    offsets = np.cumsum([0, *(len(run) for run in runs)], dtype=np.int64)
    points = np.concatenate([np.empty((0, 2)), *runs])
    return Wake(points, offsets, stay, np.empty((0, 2)), np.empty((0, 2), dtype=np.int64))


def simplified(points: FloatArray, tolerance: FloatArray) -> FloatArray:
    """Return a polyline through some of the points of another that is as close as it has to be.

    Douglas and Peucker's algorithm (1973) with a tolerance of its own for every point.

    >>> simplified(np.array([[0.0, 0.0], [1.0, 0.2], [2.0, 0.0]]), np.full(3, 0.3)).tolist()
    [[0.0, 0.0], [2.0, 0.0]]

    Args:
        points: [um]; (p, 2).
        tolerance: Largest distance of each point from the result [um], > 0; (p,).
    """
    kept = np.zeros(len(points), dtype=np.bool_)
    kept[[0, -1]] = True
    open_parts = [(0, len(points) - 1)]
    while open_parts:
        first, last = open_parts.pop()
        if last - first < 2:
            continue
        gap = segment_distance(points[first + 1 : last], points[first], points[last])
        excess = gap / tolerance[first + 1 : last]
        worst = int(np.argmax(excess))
        if excess[worst] > 1.0:
            middle = first + 1 + worst
            kept[middle] = True
            open_parts += [(first, middle), (middle, last)]
    return points[kept]


def segment_distance(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the distance of points from a straight line between two others [um]; (n,)."""
    way = end - start
    square = float(way @ way)
    along = np.zeros(len(points)) if square == 0.0 else (points - start) @ way / square
    gap = points - start - np.clip(along, 0.0, 1.0)[:, None] * way
    return np.asarray(np.hypot(gap[:, 0], gap[:, 1]))


def wake_lines(wake: Wake, spacing_at: SpacingAt) -> list[FloatArray]:
    """Return the lines that stand for the runs of a wake [um]; (p, 2) each."""
    return [simplified(run, TOLERANCE * spacing_at(run)) for run in wake.runs]
