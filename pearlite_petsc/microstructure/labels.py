"""Label map: prior austenite grains hold blocks hold colonies, each with one lamella direction.

The map is made in the undeformed pre-image F^-1(window) and a margin round it. Every level is a
Voronoi tessellation inside its parent: a point belongs to the nearest grain seed, then to the
nearest block seed among that grain's, then to the nearest colony seed among that block's. So a
child lies in one parent exactly, and all cells are convex.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.errors import MeshError
from pearlite_petsc.microstructure.hard_core import hard_core_points
from pearlite_petsc.microstructure.shear import deformation_gradient, sheared_angle
from pearlite_petsc.scene import Microstructure, State, Window

# Keys of the random streams of one mesh: SeedSequence(seed, spawn_key=(index, key)).
GRAIN, BLOCK, COLONY, ANGLE, LATTICE, PRIORITY, FILLING = range(7)

MARGIN = 3.0
"""Width of the margin round the pre-image, in diameters of the level."""

HARD_CORE = 0.72
"""Least distance of seeds in units of the mean spacing 1/sqrt(their intensity)."""

_THINNING = 2.0

_BLOCK = 2**14
# Points searched at a time, so that what is known of them stays in the processor's cache.

# Seeds per target cell area pi/4 d^2, over the ratio of the diameter to the parent's: some seeds'
# cells are cut by the parents' borders, and parents without a seed count as one.
# Measured so that the mean equivalent circle diameter is the target (1 % over forty meshes).
_RATIO = np.array([0.0, 1e-9, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0])
_SEEDS_PER_CELL = np.array([1.33, 1.3, 1.3, 1.29, 1.285, 1.27, 1.24, 1.2, 1.11, 1.0, 0.0])


def stream(seed: int, index: int, key: int) -> np.random.Generator:
    """Return the random stream of one purpose in one mesh."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index, key)))


PointLabels = tuple[IntArray, IntArray, IntArray]
"""Prior austenite grain, block and colony of points; (n,) each."""


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """Seeds of one level in undeformed coordinates.

    Attributes:
        seeds: [um]; (n, 2).
        parent: Cell of the level above each belongs to (0 for grains); (n,).
        order: Seeds sorted by parent; (n,).
        start: The children of parent p are order[start[p]:start[p + 1]].
        tree: Search among all seeds, for the level without parents.
    """

    seeds: FloatArray
    parent: IntArray
    order: IntArray
    start: IntArray
    tree: cKDTree

    @classmethod
    def of(cls, seeds: FloatArray, parent: IntArray) -> "Level":
        """Return a level from its seeds and their parents, of which each has at least one."""
        start = np.concatenate([[0], np.cumsum(np.bincount(parent))]).astype(np.int64)
        order = np.argsort(parent, kind="stable").astype(np.int64)
        return cls(seeds, parent, order, start, cKDTree(seeds))

    def nearest(self, points: FloatArray, parent: IntArray) -> IntArray:
        """Return the nearest seed with the given parent; points (n, 2) undeformed, (n,)."""
        if len(self.start) == 2:
            return np.asarray(self.tree.query(points)[1], dtype=np.int64)
        best = np.empty(len(points), dtype=np.int64)
        for start in range(0, len(points), _BLOCK):
            part = slice(start, start + _BLOCK)
            best[part] = self._nearest_sibling(points[part], parent[part])
        return best

    def _nearest_sibling(self, points: FloatArray, parent: IntArray) -> IntArray:
        first, last = self.start[parent], self.start[parent + 1] - 1
        x, y = np.ascontiguousarray(points.T)
        best: IntArray = self.order[first]
        least = self._squared_distance(x, y, best)
        for rank in range(1, int((last - first).max(initial=0)) + 1):
            other = self.order[np.minimum(first + rank, last)]
            distance = self._squared_distance(x, y, other)
            closer = distance < least
            best = np.where(closer, other, best)
            least = np.where(closer, distance, least)
        return best

    def _squared_distance(self, x: FloatArray, y: FloatArray, seed: IntArray) -> FloatArray:
        # By components: arithmetic on rows of two takes ten times as long.
        return np.asarray((x - self.seeds[seed, 0]) ** 2 + (y - self.seeds[seed, 1]) ** 2)


@dataclass(frozen=True, slots=True, eq=False)
class LabelMap:
    """Nested microstructure of one window.

    Attributes:
        levels: Grains, blocks, colonies.
        lamella_angle: After shear, in [0, pi) [rad]; one a colony.
        undeformed_angle: Before shear; one a colony.
        deformation: F; (2, 2).
        window: Width and height [um].
    """

    levels: tuple[Level, Level, Level]
    lamella_angle: FloatArray
    undeformed_angle: FloatArray
    deformation: FloatArray
    window: tuple[float, float]

    def labels(self, points: FloatArray, known_grain: IntArray | None = None) -> PointLabels:
        """Return prior austenite grain, block and colony of points in the window.

        Args:
            points: [um]; (n, 2).
            known_grain: Grain of each where it is known, else -1; (n,). Spares half of the search.
        """
        return self.labels_undeformed(points @ np.linalg.inv(self.deformation).T, known_grain)

    def labels_undeformed(
        self, points: FloatArray, known_grain: IntArray | None = None
    ) -> PointLabels:
        """Return ``labels`` of points given before shear [um]; (n, 2)."""
        grains, blocks, colonies = self.levels
        grain = np.full(len(points), -1) if known_grain is None else known_grain.copy()
        unknown = np.flatnonzero(grain < 0)
        grain[unknown] = grains.nearest(points[unknown], np.zeros(len(unknown), dtype=np.int64))
        block = blocks.nearest(points, grain)
        return grain, block, colonies.nearest(points, block)

    def boundaries(self, one: PointLabels, other: PointLabels) -> tuple[IntArray, FloatArray]:
        """Return which boundary lies between points, and its unit normal after shear.

        A boundary bisects the seeds of the two grains, of two blocks of one grain or of two
        colonies of one block; shear carries it along, so that its normal turns with F^-T.

        Args:
            one, other: What ``labels`` gives for points on the two sides; (n,) each.

        Returns:
            Level at which they part: 0 grain, 1 block, 2 colony, 3 none (n,); normals, 0 where
            there is none (n, 2).
        """
        level = np.full(len(one[0]), len(self.levels))
        normal = np.zeros((len(level), 2))
        for number in reversed(range(len(self.levels))):
            apart = one[number] != other[number]
            level[apart] = number
            seeds = self.levels[number].seeds
            normal[apart] = seeds[other[number][apart]] - seeds[one[number][apart]]
        normal = normal @ np.linalg.inv(self.deformation)
        size = np.hypot(normal[:, 0], normal[:, 1])
        return level, normal / np.where(size > 0.0, size, 1.0)[:, None]


def make_label_map(
    microstructure: Microstructure, window: Window, state: State, index: int
) -> LabelMap:
    """Make the microstructure of one mesh; a pure function of its arguments.

    Args:
        microstructure: Mean equivalent circle diameters [um] and seed.
        window: Size of the window [um].
        state: Shear strain and orientation.
        index: Number of the mesh, >= 0.

    Raises:
        MeshError: The sizes are not positive or do not descend.
    """
    sizes = (microstructure.prior_austenite_grain, microstructure.block, microstructure.colony)
    if not sizes[0] >= sizes[1] >= sizes[2] > 0:
        raise MeshError(
            "microstructure: sizes must descend from prior austenite grain over block to colony, "
            f"got {sizes[0]:g}, {sizes[1]:g}, {sizes[2]:g} um"
        )
    deformation = deformation_gradient(state.shear_strain, state.orientation)
    levels: list[Level] = []
    ratio = 0.0
    for key, size in enumerate(sizes):
        if key:
            ratio = size / sizes[key - 1]
        seeds = _seeds(size, ratio, window, deformation, stream(microstructure.seed, index, key))
        parent = np.zeros(len(seeds), dtype=np.int64)
        for level in levels:
            parent = level.nearest(seeds, parent)
        if levels:
            above = levels[-1].seeds
            empty = np.setdiff1d(np.arange(len(above)), parent)
            seeds = np.concatenate([seeds, above[empty]])
            parent = np.concatenate([parent, empty])
        levels.append(Level.of(seeds, parent))
    angles = stream(microstructure.seed, index, ANGLE).random(len(levels[2].seeds)) * np.pi
    return LabelMap(
        (levels[0], levels[1], levels[2]),
        sheared_angle(angles, deformation),
        angles,
        deformation,
        (window.width, window.height),
    )


def _seeds(
    size: float, ratio: float, window: Window, deformation: FloatArray, rng: np.random.Generator
) -> FloatArray:
    """Return hard-core seeds [um] of one level in the pre-image and its margin; (n, 2)."""
    intensity = float(np.interp(ratio, _RATIO, _SEEDS_PER_CELL)) / (0.25 * np.pi * size**2)
    # A strip of width m along a sheared edge is m sqrt(1 + gamma^2) wide in the sheared frame.
    stretch = np.hypot(1.0, [deformation[0, 1], deformation[1, 0]])
    wide, high = MARGIN * size * stretch
    box = (-wide, -high, window.width + wide, window.height + high)
    if not intensity > 0:
        return np.empty((0, 2))
    return hard_core_points(
        box,
        np.linalg.inv(deformation),
        _THINNING * intensity,
        HARD_CORE / np.sqrt(intensity),
        rng,
    )
