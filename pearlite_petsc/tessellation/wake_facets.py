"""The facets of a mesh that are open because the wake of a crack passes there."""

from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.errors import MeshError
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.wake import SpacingAt, Wake, segment_distance

_STRAYING = 3.0
# Facets further from a line are none of its own, in the spacing of the nuclei there.

_LENGTH_COST = 0.05
# Of a facet that lies on its line, over the cost of one that is a spacing off.


def run_ends(mesh: Mesh, wake: Wake) -> list[tuple[int, int]]:
    """Return the junctions of a mesh at both ends of each run."""
    vertices = cKDTree(mesh.vertices)
    found = [vertices.query(run[[0, -1]])[1] for run in wake.runs]
    return [(int(mesh.junction[a]), int(mesh.junction[b])) for a, b in found]


def wake_facets(
    mesh: Mesh, wake: Wake, lines: list[FloatArray], spacing_at: SpacingAt
) -> BoolArray:
    """Return the interfaces that are open because a run of the wake passes there; (k,).

    Those of each run hang together from the one end of it to the other, and stray as little from
    its line as they can.

    Raises:
        MeshError: No facets lead from the one end to the other.
    """
    cut = np.zeros(mesh.interface_count, dtype=np.bool_)
    tree = cKDTree(mesh.midpoint)
    for line, (start, end) in zip(lines, run_ends(mesh, wake), strict=True):
        if start == end:
            continue
        reach = _STRAYING * spacing_at(line)
        extent = np.hypot(*np.diff(line, axis=0).T)
        middle = 0.5 * (line[:-1] + line[1:])
        rows = tree.query_ball_point(middle, 0.5 * extent + np.maximum(reach[:-1], reach[1:]))
        near = np.unique(np.concatenate([np.asarray(row, dtype=np.int64) for row in rows]))
        stray = _line_distance(mesh.midpoint[near], line) / spacing_at(mesh.midpoint[near])
        cost = mesh.length[near] * (stray + _LENGTH_COST)
        cut[near[_shortest(mesh.junction[mesh.interface_vertices[near]], cost, start, end)]] = True
    return cut


def _shortest(ends: IntArray, cost: FloatArray, start: int, end: int) -> IntArray:
    """Return the edges of the cheapest way between two junctions.

    Args:
        ends: Junctions at both ends of each edge; (e, 2).
        cost: Of each, > 0; (e,).
        start, end: The two.
    """
    junctions, places = np.unique(np.append(ends.ravel(), [start, end]), return_inverse=True)
    count = len(junctions)
    places = places.reshape(-1)
    a, b = np.sort(places[:-2].reshape(-1, 2), axis=1).T
    # One edge between two junctions, the cheapest: a sparse matrix would add them up.
    order = np.lexsort((cost, b, a))
    key = a[order] * count + b[order]
    order = order[np.flatnonzero(np.diff(key, prepend=-1))]
    graph = csr_array((cost[order], (a[order], b[order])), shape=(count, count))
    first, last = int(places[-2]), int(places[-1])
    _, before = dijkstra(graph, directed=False, indices=first, return_predecessors=True)
    edge = {(int(a[row]), int(b[row])): int(row) for row in order}
    way = []
    while last != first:
        previous = int(before[last])
        if previous < 0:
            raise MeshError("no chain of facets connects the two ends of the crack's wake")
        way.append(edge[min(previous, last), max(previous, last)])
        last = previous
    return np.array(way, dtype=np.int64)


def _line_distance(points: FloatArray, line: FloatArray) -> FloatArray:
    """Return the distance of points from a polyline [um]; (n, 2) and (p, 2) to (n,)."""
    nearest = np.full(len(points), np.inf)
    for start, end in pairwise(line):
        np.minimum(nearest, segment_distance(points, start, end), out=nearest)
    return nearest
