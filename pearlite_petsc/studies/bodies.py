"""Meshes of simple bodies: one material, given nuclei, a straight line for a crack."""

from dataclasses import replace

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.scene import Kind, Window
from pearlite_petsc.tessellation.assemble import Labels, assemble
from pearlite_petsc.tessellation.curve import hilbert_order
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.voronoi import bounded_voronoi


def plain_mesh(
    points: FloatArray, width: float, height: float, largest: float | None = None
) -> Mesh:
    """Return the mesh of nuclei in a window without a notch; no facet is dropped.

    Args:
        points: Nuclei inside the window [um]; (n, 2).
        width, height: Of the window [um].
        largest: Extent of the largest element [um]; None where all are of about one size.
    """
    points = points[hilbert_order(points)]
    count = len(points)
    reach = np.full(count, largest or 3.0 * np.sqrt(width * height / count))
    diagram = bounded_voronoi(points, width, height, reach)
    gap = points[diagram.pairs[:, 1]] - points[diagram.pairs[:, 0]]
    label = np.zeros(count, dtype=np.int64)
    return assemble(
        diagram,
        points,
        gap / np.hypot(gap[:, 0], gap[:, 1])[:, None],
        np.zeros(len(gap), dtype=np.bool_),
        Labels(label, label, label, np.zeros(count)),
        np.arange(count),
        np.ones(count, dtype=np.bool_),
        Window(width, height, 0.0),
        # Only facets shorter than a share of this length would be dropped.
        1e-6,
        ("plain", 0, 0),
    )


def tensor_points(x_edges: FloatArray, y_edges: FloatArray) -> FloatArray:
    """Return nuclei in the middle of a grid's cells; a uniform grid gives its cells again."""
    x, y = 0.5 * (x_edges[1:] + x_edges[:-1]), 0.5 * (y_edges[1:] + y_edges[:-1])
    return np.asarray(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))


def random_points(count: int, width: float, height: float, seed: int) -> FloatArray:
    """Return nuclei at random, the worst case of a Voronoi mesh; (n, 2)."""
    return np.random.default_rng(seed).random((count, 2)) * [width, height]


def hexagonal_points(columns: int, rows: int) -> tuple[FloatArray, float, float]:
    """Return nuclei of a hexagonal packing of unit spacing with its window's width and height."""
    row, column = np.divmod(np.arange(rows * columns), columns)
    pitch = np.sqrt(0.75)
    x = 0.25 + column + 0.5 * (row % 2)
    return np.stack([x, (row + 0.5) * pitch], axis=1), float(columns), float(rows * pitch)


def rotated(mesh: Mesh, angle: float) -> Mesh:
    """Return the mesh turned about the origin by an angle [rad]; window and notch keep their place."""
    turn = rotation(angle)
    turned = {
        name: getattr(mesh, name) @ turn.T for name in ("vertices", "centre", "midpoint", "normal")
    }
    return replace(mesh, **turned)


def rotation(angle: float) -> FloatArray:
    """Return the matrix that turns vectors by an angle [rad]; (2, 2)."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, -sin], [sin, cos]])


def on_line(mesh: Mesh, height: float, first: float, last: float) -> BoolArray:
    """Return which interfaces lie on a horizontal line between two x [um]; (k,)."""
    ends = mesh.vertices[mesh.interface_vertices]
    flat = np.abs(ends[:, :, 1] - height).max(axis=1) < 1e-7 * mesh.window[1]
    x = mesh.midpoint[:, 0]
    return np.asarray(flat & (x > first) & (x < last))


def notch_between(mesh: Mesh, first: float, last: float) -> BoolArray:
    """Return which interfaces of the notch lie between two x [um]; (k,)."""
    x = mesh.midpoint[:, 0]
    return np.asarray((mesh.kind == Kind.NOTCH) & (x > first) & (x < last))
