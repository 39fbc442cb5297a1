"""Mesh by affine shear, the source's other reading: mesh the undeformed state, move its vertices.

The cells are not Voronoi cells after shear, which makes the elastic answer wrong; the option is
there for comparison. Elements that the notch line cuts are split in two. As a clipped cell need
not hold its moved nucleus, the centre of an element is the centroid of its polygon here, and an
interface's normal is that of its facet.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import Delaunay

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.errors import MeshError
from pearlite_petsc.microstructure.cells import LevelCells, nearest_cells, window_cells
from pearlite_petsc.microstructure.convex import Polygons
from pearlite_petsc.microstructure.hard_core import conflicting_pairs
from pearlite_petsc.microstructure.labels import FILLING, PRIORITY, LabelMap, stream
from pearlite_petsc.scene import Elements, State, Window
from pearlite_petsc.tessellation.assemble import DROPPING, Labels, assemble
from pearlite_petsc.tessellation.curve import hilbert_order
from pearlite_petsc.tessellation.lattice import HOLE, Metric, lattice
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.notch_split import split_at_notch
from pearlite_petsc.tessellation.nuclei import lattice_origin
from pearlite_petsc.tessellation.voronoi import Diagram, closed_diagram, merged_groups

_MARGIN = 4.0
# Width of the strip of cells outside the window, in element lengths, that closes those inside.

_JOINING = 1e-6
# Clipped neighbours agree on a corner up to rounding times the shear [um].


def affine_mesh(
    label_map: LabelMap, elements: Elements, window: Window, state: State, seed: int, index: int
) -> Mesh:
    """Return the mesh of the undeformed state after shear; it is fine everywhere.

    Raises:
        MeshError: The window holds too few elements or the notch cannot be followed.
    """
    spacing = float(np.sqrt(elements.width * elements.length))
    cells = affine_cells(label_map, elements, window, seed, index, DROPPING * spacing)
    diagram = diagram_of(cells, window)
    centre = centroids(cells)
    step = diagram.vertices[diagram.facets[:, 1]] - diagram.vertices[diagram.facets[:, 0]]
    normal = np.stack([step[:, 1], -step[:, 0]], axis=1) / np.hypot(*step.T)[:, None]
    grain, block, colony = label_map.labels_undeformed(cells.nuclei)
    x, y = diagram.vertices[diagram.facets].transpose(2, 0, 1)
    on_line = (y == 0.5 * window.height).all(axis=1) & (x.mean(axis=1) < window.notch)
    return assemble(
        diagram,
        centre,
        normal,
        on_line,
        Labels(grain, block, colony, label_map.lamella_angle[colony]),
        cells.nucleus,
        np.ones(len(centre), dtype=np.bool_),
        window,
        spacing,
        (state.name, index, seed),
        label_map if elements.kinds == "cut" else None,
    )


@dataclass(frozen=True, slots=True, eq=False)
class AffineCells:
    """Sheared cells clipped to the window, with the elements on the notch line split.

    Attributes:
        vertices: [um]; (m, 2).
        offsets, vertex_indices: Counter-clockwise polygons, as in Mesh.
        nuclei: Nucleus of each element before shear [um]; (n, 2).
        nucleus: Its number, that of a lower half counted on from the last; (n,).
    """

    vertices: FloatArray
    offsets: IntArray
    vertex_indices: IntArray
    nuclei: FloatArray
    nucleus: IntArray


def affine_cells(
    label_map: LabelMap, elements: Elements, window: Window, seed: int, index: int, snap: float
) -> AffineCells:
    """Return the cells of the undeformed state after shear.

    Args:
        label_map: Microstructure.
        elements: Width and length of the elements before shear [um].
        window: Size and notch [um].
        seed: Of the microstructure.
        index: Number of the mesh.
        snap: Vertices closer than this to the notch line are moved onto it [um].

    Raises:
        MeshError: Fewer than three nuclei.
    """
    nuclei = undeformed_nuclei(label_map, elements, window, seed, index)
    if len(nuclei) < 4:
        raise MeshError(f"window holds {len(nuclei)} nuclei, at least 4 are needed")
    low, high = nuclei.min(axis=0) - elements.length, nuclei.max(axis=0) + elements.length
    ones = np.ones((len(nuclei), 1))
    offsets, indices = Delaunay(nuclei).vertex_neighbor_vertices
    cells = nearest_cells(
        nuclei,
        Polygons.boxes(ones * low, ones * high),
        (offsets.astype(np.int64), indices.astype(np.int64)),
    )
    cells = cells.mapped(label_map.deformation).clipped_to_box(
        0.0, 0.0, window.width, window.height
    )
    number = np.flatnonzero(cells.count).astype(np.int64)
    vertices, polygons = _joined(cells.take(number), window, 2.0 * snap)
    middle = 0.5 * window.height
    vertices[np.abs(vertices[:, 1] - middle) < snap, 1] = middle
    large = [row for row, polygon in enumerate(polygons) if len(polygon) > 2]
    number, polygons = number[large], [polygons[row] for row in large]
    vertices, polygons, parent, lower = split_at_notch(vertices, polygons, window)
    order = hilbert_order(np.array([vertices[polygon].mean(axis=0) for polygon in polygons]))
    polygons = [polygons[row] for row in order]
    parent, lower = parent[order], lower[order]
    offsets = np.concatenate([[0], np.cumsum([len(polygon) for polygon in polygons])])
    return AffineCells(
        vertices,
        offsets.astype(np.int64),
        np.concatenate(polygons).astype(np.int64),
        nuclei[number[parent]],
        number[parent] + len(nuclei) * lower,
    )


def diagram_of(cells: AffineCells, window: Window) -> Diagram:
    """Return the facets that cells share, and those on the window's edge.

    Raises:
        MeshError: The cells do not fill the window, or neighbours do not share their edges.
    """
    indices, offsets = cells.vertex_indices, cells.offsets
    following = np.arange(1, len(indices) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    ends = np.stack([indices, indices[following]], axis=1)
    owner = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    key = ends.min(axis=1) * len(cells.vertices) + ends.max(axis=1)
    order = np.argsort(key, kind="stable")
    key, ends, owner = key[order], ends[order], owner[order]
    first = np.flatnonzero(np.diff(key, prepend=-1))
    uses = np.diff(np.append(first, len(key)))
    shared, single = first[uses == 2], first[uses == 1]
    edge = cells.vertices[ends[single]]
    outer = [(edge[:, :, axis] == value).all(axis=1) for axis, value in _edges(window)]
    if (uses > 2).any() or not np.any(outer, axis=0).all():
        raise MeshError("affine shear: neighbouring elements do not share their edges")
    pairs = np.stack([owner[shared], owner[shared + 1]], axis=1)
    facets = ends[shared]
    backward = pairs[:, 0] > pairs[:, 1]
    pairs[backward], facets[backward] = pairs[backward, ::-1], facets[backward, ::-1]
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    diagram = Diagram(
        cells.vertices,
        offsets,
        indices,
        pairs[order],
        facets[order],
        owner[single],
        ends[single],
    )
    return closed_diagram(diagram, window.width, window.height)


def centroids(cells: AffineCells) -> FloatArray:
    """Return the centroids of cells [um]; (n, 2)."""
    indices, offsets = cells.vertex_indices, cells.offsets
    following = np.arange(1, len(indices) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    start = cells.vertices[indices[offsets[:-1]]]
    origin = np.repeat(start, np.diff(offsets), axis=0)
    a, b = cells.vertices[indices] - origin, cells.vertices[indices[following]] - origin
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    moment = np.add.reduceat((a + b) * cross[:, None], offsets[:-1])
    return np.asarray(start + moment / (3.0 * np.add.reduceat(cross, offsets[:-1]))[:, None])


def _edges(window: Window) -> tuple[tuple[int, float], ...]:
    return (0, 0.0), (0, window.width), (1, 0.0), (1, window.height)


def undeformed_nuclei(
    label_map: LabelMap, elements: Elements, window: Window, seed: int, index: int
) -> FloatArray:
    """Return the nuclei of the undeformed state in and round the window's pre-image [um]; (n, 2)."""
    backward = np.linalg.inv(label_map.deformation)
    flat = replace(label_map, deformation=np.eye(2), lamella_angle=label_map.undeformed_angle)
    metric = Metric(flat, elements)
    margin = _MARGIN * elements.length
    colonies = window_cells(label_map, margin)[2]
    before = LevelCells(colonies.polygons.mapped(backward), colonies.label)
    origin = backward @ lattice_origin(elements, window, seed, index)
    points = lattice(before, flat, elements, origin)
    points = metric.thinned(points, stream(seed, index, PRIORITY).random(len(points)))
    rng = stream(seed, index, FILLING)
    x, y = margin * np.hypot(1.0, [label_map.deformation[0, 1], label_map.deformation[1, 0]])
    size = np.array([window.width + 2 * x, window.height + 2 * y])
    count = int(3.0 * size.prod() / min(elements.width, elements.length) ** 2)
    candidates = (rng.random((count, 2)) * size - [x, y]) @ backward.T
    holes = candidates[metric.far_from(candidates, points, HOLE)]
    return np.concatenate([points, metric.spread(holes)])


def _joined(cells: Polygons, window: Window, smallest: float) -> tuple[FloatArray, list[IntArray]]:
    """Return common vertices and the polygons that refer to them.

    Cells smaller than ``smallest`` [um], which would have no interface, shrink to a point.
    """
    used = cells.used()
    corners = cells.points[used]
    for axis, value in _edges(window):
        corners[np.abs(corners[:, axis] - value) < _JOINING, axis] = value
    start = np.concatenate([[0], np.cumsum(cells.count)])
    extent = np.maximum.reduceat(corners, start[:-1]) - np.minimum.reduceat(corners, start[:-1])
    tiny = np.repeat(np.hypot(extent[:, 0], extent[:, 1]) < smallest, cells.count)
    own = np.flatnonzero(tiny)
    shrunk = np.stack([own, np.repeat(start[:-1], cells.count)[own]], axis=1)
    joined = np.concatenate([conflicting_pairs(corners, _JOINING), shrunk])
    group = merged_groups(len(corners), joined)
    kept, number = np.unique(group, return_inverse=True)
    number = number.reshape(-1)
    # The corner that stands for a group is the one on most of the window's edges.
    edges = sum((corners[:, axis] == value).astype(np.int64) for axis, value in _edges(window))
    order = np.lexsort((edges, number))
    last = np.flatnonzero(np.diff(number[order], append=len(kept)))
    rows = np.split(number, start[1:-1])
    return corners[order[last]], [row[row != np.roll(row, 1)].astype(np.int64) for row in rows]
