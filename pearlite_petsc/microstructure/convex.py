"""Many convex polygons at once: clipping by half-planes, areas.

Polygons are padded: ``points`` (n, K, 2) counter-clockwise, of which the first ``count`` (n,) of
each row are used. An empty polygon has count 0.
"""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Polygons:
    """Convex polygons [um], padded.

    Attributes:
        points: (n, K, 2), counter-clockwise; what follows a polygon's last point is undefined.
        count: Points of each polygon; (n,).
    """

    points: FloatArray
    count: IntArray

    @classmethod
    def boxes(cls, lower: FloatArray, upper: FloatArray) -> "Polygons":
        """Return rectangles from their lower left and upper right corners; (n, 2) each."""
        corners = np.stack(
            [
                lower,
                np.stack([upper[:, 0], lower[:, 1]], axis=1),
                upper,
                np.stack([lower[:, 0], upper[:, 1]], axis=1),
            ],
            axis=1,
        )
        return cls(corners, np.full(len(lower), 4, dtype=np.int64))

    def take(self, index: IntArray | BoolArray) -> "Polygons":
        """Return some of the polygons, in the order asked for."""
        return Polygons(self.points[index], self.count[index])

    def used(self) -> BoolArray:
        """Return which of the padded points are in use; (n, K)."""
        return np.arange(self.points.shape[1]) < self.count[:, None]

    def area(self) -> FloatArray:
        """Return the areas [um^2]; (n,)."""
        if not self.points.size:
            return np.zeros(len(self.count))
        relative = self.points - self.points[:, :1]
        following = np.take_along_axis(relative, _following(self)[:, :, None], axis=1)
        cross = relative[..., 0] * following[..., 1] - relative[..., 1] * following[..., 0]
        return np.asarray(0.5 * np.where(self.used(), cross, 0.0).sum(axis=1))

    def mapped(self, matrix: FloatArray) -> "Polygons":
        """Return the polygons after a linear map with positive determinant; matrix (2, 2)."""
        return Polygons(self.points @ matrix.T, self.count)

    def listed(self) -> list[FloatArray]:
        """Return the polygons as a list of (count, 2) arrays."""
        return [row[:used] for row, used in zip(self.points, self.count, strict=True)]

    def clipped(self, normal: FloatArray, offset: FloatArray) -> "Polygons":
        """Keep what lies in a half-plane of each polygon's own.

        Args:
            normal: Kept is where normal . x <= offset; (n, 2).
            offset: (n,).

        Returns:
            The clipped polygons, count 0 where nothing is left.
        """
        if not len(self.count):
            return self
        side = np.einsum("nkd,nd->nk", self.points, normal) - offset[:, None]
        touched = np.flatnonzero(((side > 0) & self.used()).any(axis=1))
        if not len(touched):
            return self
        cut = _clip(self.take(touched), side[touched])
        width = max(self.points.shape[1], cut.points.shape[1])
        points = np.zeros((len(self.count), width, 2))
        points[:, : self.points.shape[1]] = self.points
        points[touched, : cut.points.shape[1]] = cut.points
        count = self.count.copy()
        count[touched] = cut.count
        width = max(1, int(count.max()))
        return Polygons(points[:, :width], count)

    def clipped_to_box(self, x0: float, y0: float, x1: float, y1: float) -> "Polygons":
        """Keep what lies in a box [um]."""
        result = self
        n = len(self.count)
        for normal, offset in (((-1, 0), -x0), ((1, 0), x1), ((0, -1), -y0), ((0, 1), y1)):
            normals = np.broadcast_to(np.array(normal, dtype=np.float64), (n, 2))
            result = result.clipped(normals, np.full(n, float(offset)))
        return result


def _following(polygons: Polygons) -> IntArray:
    index = np.arange(1, polygons.points.shape[1] + 1)
    return np.where(index < polygons.count[:, None], index, 0).astype(np.int64)


def _clip(polygons: Polygons, side: FloatArray) -> Polygons:
    """Clip polygons of which side (n, K) is the signed distance of the points, positive outside."""
    following = _following(polygons)
    side_next = np.take_along_axis(side, following, axis=1)
    points_next = np.take_along_axis(polygons.points, following[:, :, None], axis=1)
    used = polygons.used()
    inside = used & (side <= 0)
    crossing = used & ((side < 0) & (side_next > 0) | (side > 0) & (side_next < 0))
    share = side / np.where(crossing, side - side_next, 1.0)
    crossed = polygons.points + share[:, :, None] * (points_next - polygons.points)
    n, k = side.shape
    points = np.stack([polygons.points, crossed], axis=2).reshape(n, 2 * k, 2)
    kept = np.stack([inside, crossing], axis=2).reshape(n, 2 * k)
    count = kept.sum(axis=1)
    # A polygon that only touches the line from outside leaves one or two points.
    count = np.where(count < 3, 0, count).astype(np.int64)
    order = np.argsort(~kept, axis=1, kind="stable")[:, : max(1, int(count.max()))]
    return Polygons(np.take_along_axis(points, order[:, :, None], axis=1), count)
