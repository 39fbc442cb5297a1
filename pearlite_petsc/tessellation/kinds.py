"""What interfaces are: boundaries, along the lamellae or across them.

Two rules. ``labels`` asks the two elements: different labels make a boundary. ``cut`` asks the
label map along the facet: a boundary is one only where it runs along the facet, and everywhere
else the lamellae decide that lie there.
"""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.microstructure.labels import LabelMap, PointLabels
from pearlite_petsc.scene import Kind

SAMPLES = 4
"""Places along a facet at which ``cut`` asks the label map on both sides."""

REACH = 1.0
"""How far to each side, as a share of the way to the elements' centres: strips of neighbouring
facets then touch, and a boundary belongs to one row of facets.
"""

STEEP = float(np.sqrt(0.5))
"""Sine of the angle from which a facet cuts lamellae or a boundary crosses it: 45 degrees."""


@dataclass(frozen=True, slots=True, eq=False)
class Facets:
    """Facets between elements, and what the elements are.

    Attributes:
        vertices: [um]; (m, 2).
        ends: End vertices; (k, 2).
        normal: Unit normals; (k, 2).
        pairs: Elements on both sides; (k, 2).
        spacing: Distance of the two centres along the normal [um]; (k,).
        labels: Of the elements; (n,) each.
        lamella_angle: Of the elements [rad]; (n,).
    """

    vertices: FloatArray
    ends: IntArray
    normal: FloatArray
    pairs: IntArray
    spacing: FloatArray
    labels: PointLabels
    lamella_angle: FloatArray


def kinds_by_labels(facets: Facets) -> IntArray:
    """Return the kind of each facet by the labels of its two elements, as values of `Kind`; (k,).

    Inside a colony a facet within 45 degrees of the lamellae is `lamella`, else `cementite`.
    """
    pairs = facets.pairs
    cuts = _cuts(facets.normal, facets.lamella_angle[pairs[:, 0]])
    grain, block, colony = (label[pairs[:, 0]] == label[pairs[:, 1]] for label in facets.labels)
    return np.select(
        [colony & ~cuts, colony, block, grain],
        [Kind.LAMELLA, Kind.CEMENTITE, Kind.COLONY, Kind.BLOCK],
        Kind.PRIOR_AUSTENITE_GRAIN,
    ).astype(np.int64)


def shares_by_cut(facets: Facets, label_map: LabelMap) -> FloatArray:
    """Return which share of each facet's length is of which kind.

    A boundary runs along a facet where it passes between the two elements' centres within 45
    degrees of the facet's direction. Elsewhere the facet cuts lamellae or runs along them, those
    of both sides counted alike where a boundary crosses. Where both elements' centres and both
    ends lie in one grain, the borders of others are left to the facets that they run between.

    Args:
        facets: The facets.
        label_map: Microstructure in the same coordinates.

    Returns:
        A column for each value of `Kind`, the notch aside; (k, 5).
    """
    shares = np.zeros((len(facets.ends), int(Kind.NOTCH)))
    corners = label_map.labels(facets.vertices)
    in_one_grain, _, in_one_colony = (
        _are_one(of_element[facets.pairs], of_corner[facets.ends])
        for of_element, of_corner in zip(facets.labels, corners, strict=True)
    )
    # Cells are convex: what has its corners in one colony or grain lies in it as a whole.
    whole = np.flatnonzero(in_one_colony)
    shares[whole, kinds_by_labels(facets)[whole]] = 1.0
    rest = np.flatnonzero(~in_one_colony)
    grain = facets.labels[0][facets.pairs[rest, 0]]
    known_grain = np.repeat(np.where(in_one_grain[rest], grain, -1), SAMPLES)
    start, end = facets.vertices[facets.ends[rest]].transpose(1, 0, 2)
    reach = 0.5 * REACH * facets.spacing[rest]
    shares[rest] = shares_along(label_map, start, end, facets.normal[rest], reach, known_grain)
    return shares


def shares_along(
    label_map: LabelMap,
    start: FloatArray,
    end: FloatArray,
    normal: FloatArray,
    reach: FloatArray,
    known_grain: IntArray | None = None,
) -> FloatArray:
    """Return which share of lines through a microstructure is of which kind.

    Args:
        label_map: The microstructure.
        start, end: Of the lines [um]; (k, 2).
        normal: Unit normals; (k, 2).
        reach: How far to each side a boundary is looked for [um]; (k,).
        known_grain: Grain at each of the places looked up, -1 where unknown; (SAMPLES k,).

    Returns:
        A column for each value of `Kind`, the notch aside; (k, 5).
    """
    share = ((np.arange(SAMPLES) + 0.5) / SAMPLES)[:, None]
    places = start[:, None] + share * (end - start)[:, None]
    step = (reach[:, None] * normal)[:, None]
    sides = [
        label_map.labels((places + sign * step).reshape(-1, 2), known_grain) for sign in (-1, 1)
    ]
    normals = np.repeat(normal, SAMPLES, axis=0)
    level, across = label_map.boundaries(*sides)
    runs_along = np.abs((normals * across).sum(axis=1)) > STEEP
    count, kinds = len(start), int(Kind.NOTCH)
    row = np.repeat(np.arange(count), SAMPLES) * kinds
    found = np.zeros(count * kinds, dtype=np.int64)
    for side in sides:
        cuts = _cuts(normals, label_map.lamella_angle[side[2]])
        kind = np.where(runs_along, Kind.PRIOR_AUSTENITE_GRAIN - level, cuts)
        found += np.bincount(row + kind, minlength=len(found))
    return found.reshape(count, kinds) / (2 * SAMPLES)


def _are_one(*labels: IntArray) -> BoolArray:
    """Return where labels in rows are all the same; (k, 2) each, (k,)."""
    every = np.concatenate(labels, axis=1)
    return np.asarray((every == every[:, :1]).all(axis=1))


def _cuts(normal: FloatArray, lamella_angle: FloatArray) -> BoolArray:
    """Return whether facets cut lamellae, by normals (n, 2) and the lamellae's directions (n,)."""
    along = normal[:, 0] * np.cos(lamella_angle) + normal[:, 1] * np.sin(lamella_angle)
    return np.asarray(np.abs(along) > STEEP)
