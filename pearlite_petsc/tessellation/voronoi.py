"""Bounded Voronoi diagram of a rectangle, as the dual of one Delaunay triangulation.

Nuclei near an edge are mirrored across it, so that the edges of the window are exact facets.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import Delaunay

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.errors import MeshError

MERGING = 1e-9
"""Vertices of neighbouring triangles closer than this share of the window's size are one."""

_EXACT = 1e-8


@dataclass(frozen=True, slots=True, eq=False)
class Diagram:
    """Voronoi cells of n nuclei.

    Attributes:
        vertices: [um]; (m, 2).
        offsets, vertex_indices: Counter-clockwise polygons, as in Mesh.
        pairs: Nuclei i < j of each facet between two cells, sorted; (k, 2).
        facets: Its end vertices, different; (k, 2).
        boundary: Cell of each facet on the window's edge; (q,).
        boundary_facets: Its end vertices, counter-clockwise round the window; (q, 2).
    """

    vertices: FloatArray
    offsets: IntArray
    vertex_indices: IntArray
    pairs: IntArray
    facets: IntArray
    boundary: IntArray
    boundary_facets: IntArray


def bounded_voronoi(points: FloatArray, width: float, height: float, reach: FloatArray) -> Diagram:
    """Return the Voronoi diagram of points inside a rectangle.

    Args:
        points: Nuclei strictly inside the rectangle [um]; (n, 2).
        width, height: Of the rectangle [um].
        reach: Nuclei closer than this to an edge are mirrored across it [um]; (n,). It is doubled
            until every cell lies in the rectangle.

    Raises:
        MeshError: Fewer than three nuclei, or cells that do not fill the rectangle.
    """
    if len(points) < 3:
        size = f"{width:g} x {height:g} um"
        raise MeshError(f"window of {size} holds {len(points)} nuclei, at least 3 are needed")
    tolerance = MERGING * max(width, height)
    while True:
        ghosts, owner, complete = _ghosts(points, width, height, reach)
        triangulation = Delaunay(np.concatenate([points, ghosts]))
        corners = triangulation.simplices.astype(np.int64)
        centres = _circumcentres(triangulation.points, corners)
        real = (corners < len(points)).any(axis=1)
        outside = np.any(
            (centres < -_EXACT) | (centres > [width + _EXACT, height + _EXACT]), axis=1
        )
        closed = not (real & outside).any()
        if closed or complete:
            break
        reach = 2.0 * reach
    diagram = _dual(triangulation, corners, centres, len(points), owner, tolerance)
    return closed_diagram(diagram, width, height)


def cell_areas(vertices: FloatArray, offsets: IntArray, indices: IntArray) -> FloatArray:
    """Return the areas of polygons given as in Mesh [um^2]; (n,)."""
    following = np.arange(1, len(indices) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    start = np.repeat(vertices[indices[offsets[:-1]]], np.diff(offsets), axis=0)
    a, b = vertices[indices] - start, vertices[indices[following]] - start
    return np.asarray(0.5 * np.add.reduceat(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], offsets[:-1]))


def _ghosts(
    points: FloatArray, width: float, height: float, reach: FloatArray
) -> tuple[FloatArray, IntArray, bool]:
    """Return mirror nuclei, the nucleus each belongs to, and whether all are mirrored."""
    parts, owners = [], []
    complete = True
    for axis, edge in ((0, 0.0), (0, width), (1, 0.0), (1, height)):
        near = np.flatnonzero(np.abs(points[:, axis] - edge) < reach)
        image = points[near].copy()
        image[:, axis] = 2.0 * edge - image[:, axis]
        parts.append(image)
        owners.append(near)
        complete = complete and len(near) == len(points)
    return np.concatenate(parts), np.concatenate(owners).astype(np.int64), complete


def _circumcentres(points: FloatArray, corners: IntArray) -> FloatArray:
    origin = points[corners[:, 0]]
    b, c = points[corners[:, 1]] - origin, points[corners[:, 2]] - origin
    bb, cc = (b * b).sum(axis=1), (c * c).sum(axis=1)
    twice = 2.0 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    # Flat triangles occur only among mirror nuclei on the outer hull; their place is not used.
    twice = np.where(twice == 0.0, np.finfo(np.float64).tiny, twice)
    with np.errstate(over="ignore", invalid="ignore"):
        x = (c[:, 1] * bb - b[:, 1] * cc) / twice
        y = (b[:, 0] * cc - c[:, 0] * bb) / twice
        return np.asarray(origin + np.stack([x, y], axis=1))


def _dual(
    triangulation: Delaunay,
    corners: IntArray,
    centres: FloatArray,
    count: int,
    owner: IntArray,
    tolerance: float,
) -> Diagram:
    neighbours = triangulation.neighbors
    triangle, opposite = np.nonzero(neighbours > np.arange(len(corners))[:, None])
    other = neighbours[triangle, opposite].astype(np.int64)
    ends = np.stack(
        [corners[triangle, (opposite + 1) % 3], corners[triangle, (opposite + 2) % 3]], axis=1
    )
    used = (ends < count).any(axis=1)
    triangle, other, ends = triangle[used], other[used], ends[used]
    span = np.abs(centres[triangle] - centres[other]).max(axis=1)
    group = merged_groups(len(corners), np.stack([triangle, other], axis=1)[span < tolerance])
    triangle, other = group[triangle], group[other]
    proper = triangle != other
    triangle, other, ends = triangle[proper], other[proper], ends[proper]

    inner = (ends < count).all(axis=1)
    outer = ~inner
    inside = np.where(ends[:, 0] < count, ends[:, 0], ends[:, 1])
    ghost = np.where(ends[:, 0] < count, ends[:, 1], ends[:, 0])
    stray = owner[ghost[outer] - count] != inside[outer]
    if stray.any():
        raise MeshError(
            f"cell {inside[outer][stray][0]} ends at the mirror image of another: "
            "nuclei too close to the window's edge"
        )
    offsets, indices = _polygons(triangulation.points, corners, centres, count, group)
    present, compact = np.unique(indices, return_inverse=True)
    number = np.full(len(corners), -1, dtype=np.int64)
    number[present] = np.arange(len(present))

    pairs = np.sort(ends[inner], axis=1)
    facets = np.stack([number[triangle[inner]], number[other[inner]]], axis=1)
    order = np.argsort(pairs[:, 0] * count + pairs[:, 1], kind="stable")
    return Diagram(
        centres[present],
        offsets,
        compact.reshape(-1).astype(np.int64),
        pairs[order],
        facets[order],
        inside[outer],
        np.stack([number[triangle[outer]], number[other[outer]]], axis=1),
    )


def merged_groups(count: int, joined: IntArray) -> IntArray:
    """Return for each of ``count`` things the smallest one it is joined with; joined (p, 2)."""
    group = np.arange(count)
    a, b = joined.T
    while not np.array_equal(group[a], group[b]):
        low = np.minimum(group[a], group[b])
        np.minimum.at(group, a, low)
        np.minimum.at(group, b, low)
    return group


def _polygons(
    points: FloatArray, corners: IntArray, centres: FloatArray, count: int, group: IntArray
) -> tuple[IntArray, IntArray]:
    """Return each cell's corners in the order of their angle about the nucleus."""
    cell = corners.ravel()
    corner = np.repeat(group, 3)
    real = cell < count
    cell, corner = cell[real], corner[real]
    spoke = centres[corner] - points[cell]
    # One sort by cell and angle: an angle is a share of the turn below one.
    turn = (np.arctan2(spoke[:, 1], spoke[:, 0]) / (2.0 * np.pi) + 0.5) * (1.0 - 1e-15)
    order = np.lexsort((turn, cell))
    cell, corner = cell[order], corner[order]
    start = np.flatnonzero(np.diff(cell, prepend=-1))
    previous = np.roll(corner, 1)
    previous[start] = corner[np.append(start[1:], len(corner)) - 1]
    proper = corner != previous
    cell, corner = cell[proper], corner[proper]
    offsets = np.concatenate([[0], np.cumsum(np.bincount(cell, minlength=count))])
    return offsets.astype(np.int64), corner.astype(np.int64)


def closed_diagram(diagram: Diagram, width: float, height: float) -> Diagram:
    """Return a diagram with vertices snapped to the window's edges and its boundary in order.

    Raises:
        MeshError: The cells do not fill the window.
    """
    vertices = diagram.vertices.copy()
    for axis, edge in ((0, 0.0), (0, width), (1, 0.0), (1, height)):
        vertices[np.abs(vertices[:, axis] - edge) < _EXACT, axis] = edge
    area = cell_areas(vertices, diagram.offsets, diagram.vertex_indices)
    if not (area > 0).all() or not abs(area.sum() - width * height) < 1e-9 * width * height:
        raise MeshError(
            f"cells cover {area.sum():.9g} um^2 of a window of {width * height:.9g} um^2"
        )
    boundary, ends = _walked(vertices, diagram, width, height)
    return Diagram(
        vertices,
        diagram.offsets,
        diagram.vertex_indices,
        diagram.pairs,
        diagram.facets,
        boundary,
        ends,
    )


def _walked(
    vertices: FloatArray, diagram: Diagram, width: float, height: float
) -> tuple[IntArray, IntArray]:
    ends = diagram.boundary_facets
    middle = 0.5 * (vertices[ends[:, 0]] + vertices[ends[:, 1]])
    x, y = middle[:, 0], middle[:, 1]
    bottom, right, top = y == 0.0, x == width, y == height
    way = np.select(
        [bottom, right, top],
        [x, width + y, 2 * width + height - x],
        2 * (width + height) - y,
    )
    step = vertices[ends[:, 1]] - vertices[ends[:, 0]]
    forward = np.select([bottom, right, top], [step[:, 0], step[:, 1], -step[:, 0]], -step[:, 1])
    ends = np.where((forward > 0)[:, None], ends, ends[:, ::-1])
    order = np.argsort(way, kind="stable")
    return diagram.boundary[order], ends[order]


def oriented_facets(vertices: FloatArray, facets: IntArray, normal: FloatArray) -> IntArray:
    """Return facets whose direction is their normal turned by +90 degrees; (k, 2)."""
    step = vertices[facets[:, 1]] - vertices[facets[:, 0]]
    backward: BoolArray = normal[:, 0] * step[:, 1] - normal[:, 1] * step[:, 0] < 0
    return np.where(backward[:, None], facets[:, ::-1], facets)
