"""Cutting in two the elements that lie across the notch line, under affine shear."""

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.scene import Window


def split_at_notch(
    vertices: FloatArray, polygons: list[IntArray], window: Window
) -> tuple[FloatArray, list[IntArray], IntArray, BoolArray]:
    """Cut the elements whose chord on the notch line has its middle before the notch's tip.

    Returns:
        Vertices, polygons, the old number of each, and whether it is a lower half.
    """
    middle = 0.5 * window.height
    side = np.sign(vertices[:, 1] - middle)
    added: list[FloatArray] = []
    on_edge: dict[tuple[int, int], int] = {}
    result: list[IntArray] = []
    parent: list[int] = []
    lower: list[bool] = []
    crossing = [
        polygon_side.min() < 0 < polygon_side.max()
        for polygon_side in (side[polygon] for polygon in polygons)
    ]
    chords = {
        row: _chord(vertices, polygons[row], middle) for row in np.flatnonzero(crossing).tolist()
    }
    cut = {row for row, (start, end) in chords.items() if start + end < 2.0 * window.notch}
    for row in cut:
        polygon = polygons[row]
        for a, b in zip(polygon.tolist(), np.roll(polygon, -1).tolist(), strict=True):
            edge = (min(a, b), max(a, b))
            if side[a] * side[b] < 0 and edge not in on_edge:
                share = (middle - vertices[a, 1]) / (vertices[b, 1] - vertices[a, 1])
                x = vertices[a, 0] + share * (vertices[b, 0] - vertices[a, 0])
                on_edge[edge] = len(vertices) + len(added)
                added.append(np.array([x, middle]))
    side = np.concatenate([side, np.zeros(len(added))])
    for row, polygon in enumerate(polygons):
        whole = _with_corners(polygon, on_edge) if crossing[row] else polygon
        # The corners on the line belong to both halves.
        sides = (side[whole] >= 0, side[whole] <= 0) if row in cut else (slice(None),)
        halves = [whole[chosen] for chosen in sides]
        result += halves
        parent += [row] * len(halves)
        lower += [False, True][: len(halves)]
    points = np.concatenate([vertices, np.array(added).reshape(-1, 2)])
    return points, result, np.array(parent, dtype=np.int64), np.array(lower)


def _chord(vertices: FloatArray, polygon: IntArray, middle: float) -> tuple[float, float]:
    """Return where a horizontal line enters and leaves a convex polygon [um]."""
    a, b = vertices[polygon], vertices[np.roll(polygon, -1)]
    meets = ((a[:, 1] <= middle) & (b[:, 1] >= middle)) | (
        (a[:, 1] >= middle) & (b[:, 1] <= middle)
    )
    meets &= a[:, 1] != b[:, 1]
    a, b = a[meets], b[meets]
    x = a[:, 0] + (middle - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return float(x.min()), float(x.max())


def _with_corners(polygon: IntArray, on_edge: dict[tuple[int, int], int]) -> IntArray:
    """Return a polygon with the new corners on its edges, so that neighbours share their edges."""
    corners: list[int] = []
    for a, b in zip(polygon.tolist(), np.roll(polygon, -1).tolist(), strict=True):
        corners.append(a)
        new = on_edge.get((min(a, b), max(a, b)))
        if new is not None:
            corners.append(new)
    return np.array(corners, dtype=np.int64)
