"""Polygons of grains, blocks and colonies, and their measured sizes."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import Delaunay

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.microstructure.convex import Polygons
from pearlite_petsc.microstructure.labels import LabelMap, Level


@dataclass(frozen=True, slots=True, eq=False)
class LevelCells:
    """Cells of one level.

    Attributes:
        polygons: [um].
        label: Number of each cell in its level; (n,).
    """

    polygons: Polygons
    label: IntArray


def undeformed_cells(label_map: LabelMap) -> tuple[Polygons, Polygons, Polygons]:
    """Return the whole cells of grains, blocks and colonies before shear, margin included.

    Cells at the outer edge of the margin are cut by a box; see `whole_cells` for those that count.
    """
    grains, blocks, colonies = label_map.levels
    outer = _outer_box(grains)
    first = nearest_cells(grains.seeds, outer, _delaunay_neighbours(grains))
    second = nearest_cells(blocks.seeds, first.take(blocks.parent), _siblings(blocks))
    third = nearest_cells(colonies.seeds, second.take(colonies.parent), _siblings(colonies))
    return first, second, third


def window_cells(
    label_map: LabelMap, margin: float = 0.0
) -> tuple[LevelCells, LevelCells, LevelCells]:
    """Return grains, blocks and colonies sheared by F and clipped to the window.

    Args:
        label_map: Microstructure.
        margin: Width of the strip round the window that is kept as well [um], measured before
            shear.
    """
    width, height = label_map.window
    # A strip of width m along a sheared edge is m sqrt(1 + gamma^2) wide in the sheared frame.
    x, y = margin * np.hypot(1.0, [label_map.deformation[0, 1], label_map.deformation[1, 0]])
    result = []
    for cells in undeformed_cells(label_map):
        polygons = cells.mapped(label_map.deformation)
        polygons = polygons.clipped_to_box(-x, -y, width + x, height + y)
        label = np.flatnonzero(polygons.count)
        result.append(LevelCells(polygons.take(label), label.astype(np.int64)))
    return result[0], result[1], result[2]


def whole_cells(label_map: LabelMap) -> tuple[BoolArray, BoolArray, BoolArray]:
    """Return which cells are counted for sizes: those whose seed lies in the window's pre-image.

    Taking the cells that lie wholly in the window would favour small ones; the margin lets every
    cell with its seed inside be measured whole.
    """
    masks = []
    for level in label_map.levels:
        points = level.seeds @ label_map.deformation.T
        masks.append(np.all((points >= 0) & (points <= label_map.window), axis=1))
    return masks[0], masks[1], masks[2]


def equivalent_diameters(label_map: LabelMap) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the equivalent circle diameters [um] of the window's grains, blocks and colonies."""
    diameters = [
        2.0 * np.sqrt(cells.area()[mask] / np.pi)
        for cells, mask in zip(undeformed_cells(label_map), whole_cells(label_map), strict=True)
    ]
    return diameters[0], diameters[1], diameters[2]


def _outer_box(grains: Level) -> Polygons:
    lower, upper = grains.seeds.min(axis=0), grains.seeds.max(axis=0)
    pad = 0.01 * (upper - lower).max() + 1.0
    n = len(grains.seeds)
    return Polygons.boxes(np.tile(lower - pad, (n, 1)), np.tile(upper + pad, (n, 1)))


def nearest_cells(
    seeds: FloatArray, start: Polygons, neighbours: tuple[IntArray, IntArray]
) -> Polygons:
    """Return what of each seed's start polygon is nearer to it than to its neighbours.

    Args:
        seeds: [um]; (n, 2).
        start: n polygons.
        neighbours: Those of seed i are indices[offsets[i]:offsets[i + 1]]; (n + 1,), (.,).
    """
    offsets, indices = neighbours
    cells = start
    degree = np.diff(offsets)
    n = len(seeds)
    for rank in range(int(degree.max(initial=0))):
        own = np.flatnonzero(degree > rank)
        other = indices[offsets[own] + rank]
        normal = np.zeros((n, 2))
        offset = np.zeros(n)
        normal[own] = seeds[other] - seeds[own]
        offset[own] = np.einsum("nd,nd->n", normal[own], 0.5 * (seeds[other] + seeds[own]))
        cells = cells.clipped(normal, offset)
    return cells


def _delaunay_neighbours(grains: Level) -> tuple[IntArray, IntArray]:
    seeds = grains.seeds
    if len(seeds) < 4:
        return _siblings(grains)
    offsets, indices = Delaunay(seeds).vertex_neighbor_vertices
    return offsets.astype(np.int64), indices.astype(np.int64)


def _siblings(level: Level) -> tuple[IntArray, IntArray]:
    """Return for each child the others of the same parent, as CSR offsets and indices."""
    first = level.start[level.parent]
    others = level.start[level.parent + 1] - first - 1
    place = np.empty(len(level.parent), dtype=np.int64)
    place[level.order] = np.arange(len(level.parent))
    offsets = np.concatenate([[0], np.cumsum(others)]).astype(np.int64)
    rank = np.arange(offsets[-1]) - np.repeat(offsets[:-1], others)
    rank += rank >= np.repeat(place - first, others)
    return offsets, level.order[np.repeat(first, others) + rank]
