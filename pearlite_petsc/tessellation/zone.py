"""The fine zone: where elements have the full resolution."""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.scene import Scene

AHEAD = 0.3
"""Share of a disc's radius by which it lies ahead of what it covers, so that it lasts longer."""


@dataclass(frozen=True, slots=True, eq=False)
class FineZone:
    """A union of boxes and discs.

    Attributes:
        boxes: x0, y0, x1, y1 [um]; (b, 4).
        discs: x, y, radius [um]; (d, 3).
    """

    boxes: FloatArray
    discs: FloatArray

    def distance(self, points: FloatArray) -> FloatArray:
        """Return the distance of points to the zone [um], 0 inside; points (n, 2), result (n,)."""
        result = np.full(len(points), np.inf)
        for x0, y0, x1, y1 in self.boxes:
            dx = np.maximum(np.maximum(x0 - points[:, 0], points[:, 0] - x1), 0.0)
            dy = np.maximum(np.maximum(y0 - points[:, 1], points[:, 1] - y1), 0.0)
            np.minimum(result, np.hypot(dx, dy), out=result)
        for x, y, radius in self.discs:
            gap = np.hypot(points[:, 0] - x, points[:, 1] - y) - radius
            np.minimum(result, np.maximum(gap, 0.0), out=result)
        return result

    def with_discs(self, points: FloatArray, radius: float) -> "FineZone":
        """Return the zone and discs of one radius [um] that cover points of a front [um], (d, 2)."""
        centres = points + np.array([AHEAD * radius, 0.0])
        discs = np.column_stack([centres, np.full(len(centres), radius)])
        return FineZone(self.boxes, np.concatenate([self.discs, discs]))


NOWHERE = FineZone(np.empty((0, 4)), np.empty((0, 3)))


def initial_zone(scene: Scene) -> FineZone:
    """Return the zone that a mesh starts with, by ``scene.elements.refinement``."""
    window, elements = scene.window, scene.elements
    if elements.refinement == "uniform" or elements.shear == "affine":
        return FineZone(np.array([[0.0, 0.0, window.width, window.height]]), NOWHERE.discs)
    middle = 0.5 * window.height
    if elements.refinement == "corridor":
        low, high = middle - elements.corridor, middle + elements.corridor
        return FineZone(np.array([[0.0, low, window.width, high]]), NOWHERE.discs)
    return NOWHERE.with_discs(np.array([[window.notch, middle]]), elements.radius)
