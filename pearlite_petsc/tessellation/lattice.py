"""Lattices of nuclei along the lamellae, and distances measured in element widths and lengths."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.microstructure.cells import LevelCells
from pearlite_petsc.microstructure.hard_core import conflicting_pairs, independent_subset
from pearlite_petsc.microstructure.labels import LabelMap
from pearlite_petsc.scene import Elements

CLOSEST = 0.6
"""Least distance of two nuclei, in element widths across and lengths along the lamellae."""

HOLE = 0.85
"""A place further than this from every nucleus gets one of its own, in the same measure."""


MOST_NEAREST = 8
"""Neighbours that are looked at before all those within reach."""

AT_ONCE = 20_000
"""Points whose neighbours are held at once: slender elements have hundreds each."""


@dataclass(frozen=True, slots=True, eq=False)
class Metric:
    """Distances in units of the element's width across and length along the local lamellae."""

    label_map: LabelMap
    elements: Elements

    def frames(self, points: FloatArray) -> FloatArray:
        """Return the metric tensors [1/um^2] at points in the window; (n, 2) to (n, 3).

        The components are xx, xy, yy.
        """
        angle = self.label_map.lamella_angle[self.label_map.labels(points)[2]]
        cos, sin = np.cos(angle), np.sin(angle)
        along, across = self.elements.length**-2, self.elements.width**-2
        return np.stack(
            [
                along * cos**2 + across * sin**2,
                (along - across) * cos * sin,
                along * sin**2 + across * cos**2,
            ],
            axis=1,
        )

    def kept(self, points: FloatArray, priority: FloatArray) -> BoolArray:
        """Return which points remain when none may be closer than `CLOSEST` to a better one."""
        return self._independent(points, priority, CLOSEST)

    def thinned(self, points: FloatArray, priority: FloatArray) -> FloatArray:
        """Return the points that remain when none may be closer than `CLOSEST` to a better one."""
        return points[self.kept(points, priority)]

    def spread(self, points: FloatArray) -> FloatArray:
        """Return points of which none is closer than `HOLE` to one before it."""
        return points[self._independent(points, np.arange(float(len(points))), HOLE)]

    def far_from(self, points: FloatArray, others: FloatArray, distance: float) -> BoolArray:
        """Return which points are further than a distance from all the others."""
        tree = cKDTree(others)
        near = min(self.elements.width, self.elements.length)
        nearest = tree.query(points, distance_upper_bound=distance * near)[0]
        candidate = np.flatnonzero(np.isinf(nearest))
        frames = self.frames(points[candidate])
        # One of the nearest settles nearly all, and slender elements have hundreds within reach.
        known = tree.query(points[candidate], np.arange(1, 1 + min(MOST_NEAREST, len(others))))[1]
        open_ = np.ones(len(candidate), dtype=np.bool_)
        for neighbour in known.T:
            gap = points[candidate] - others[neighbour]
            open_ &= _squared(frames, gap) >= distance**2
        candidate, frames = candidate[open_], frames[open_]
        far = np.zeros(len(points), dtype=np.bool_)
        reach = distance * max(self.elements.width, self.elements.length)
        for start in range(0, len(candidate), AT_ONCE):
            part = slice(start, start + AT_ONCE)
            pairs = cKDTree(points[candidate[part]]).sparse_distance_matrix(
                tree, reach, output_type="coo_matrix"
            )
            gap = points[candidate[part][pairs.row]] - others[pairs.col]
            close = _squared(frames[part][pairs.row], gap) < distance**2
            far[candidate[part]] = True
            far[candidate[part][pairs.row[close]]] = False
        return far

    def _independent(self, points: FloatArray, priority: FloatArray, distance: float) -> BoolArray:
        reach = distance * max(self.elements.width, self.elements.length)
        pairs = conflicting_pairs(points, reach)
        frames = self.frames(points)
        mean = 0.5 * (frames[pairs[:, 0]] + frames[pairs[:, 1]])
        gap = points[pairs[:, 0]] - points[pairs[:, 1]]
        return independent_subset(pairs[_squared(mean, gap) < distance**2], priority)


def lattice(
    colonies: LevelCells, label_map: LabelMap, elements: Elements, origin: FloatArray
) -> FloatArray:
    """Return the lattice nuclei of colonies [um]; (n, 2).

    Rows lie along the lamellae, ``width`` apart; points in a row are ``length`` apart. All
    lattices have one random point near the notch's tip in common: colonies of a severe state are
    thinner than an element but nearly parallel, and so their rows go on in each other, while
    lattices of clearly different directions are out of step anyway.

    Args:
        colonies: Their polygons [um].
        label_map: Microstructure in the same coordinates; a nucleus outside its colony is left out.
        elements: Width and length of the elements [um].
        origin: The common point [um]; (2,).
    """
    angle = label_map.lamella_angle[colonies.label]
    axes = np.stack(
        [
            np.stack([np.cos(angle), np.sin(angle)], axis=1),
            np.stack([-np.sin(angle), np.cos(angle)], axis=1),
        ],
        axis=1,
    )
    spacing = np.array([elements.length, elements.width])
    local = np.einsum("nkd,nad->nka", colonies.polygons.points - origin, axes) / spacing
    used = colonies.polygons.used()[:, :, None]
    first = np.ceil(np.where(used, local, np.inf).min(axis=1)).astype(np.int64)
    last = np.floor(np.where(used, local, -np.inf).max(axis=1)).astype(np.int64)
    count = np.maximum(last - first + 1, 0)
    total = count.prod(axis=1)
    owner = np.repeat(np.arange(len(total)), total)
    rank = np.arange(len(owner)) - np.repeat(np.cumsum(total) - total, total)
    step = np.stack([rank % count[owner, 0], rank // count[owner, 0]], axis=1) + first[owner]
    points = origin + np.einsum("na,nad->nd", step * spacing, axes[owner])
    return np.asarray(points[label_map.labels(points)[2] == colonies.label[owner]])


def _squared(metric: FloatArray, gap: FloatArray) -> FloatArray:
    x, y = gap[:, 0], gap[:, 1]
    return np.asarray(metric[:, 0] * x**2 + 2.0 * metric[:, 1] * x * y + metric[:, 2] * y**2)
