"""Bodies with straight, slanted and kinked cracks, fine round the tip that is looked at."""

import itertools
from collections.abc import Sequence

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.mechanics.loads import AiryFunction
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.mechanics.statics import load_vector
from pearlite_petsc.scene import Solver
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.subdomain import subdomain_of
from pearlite_petsc.studies.bodies import plain_mesh, tensor_points
from pearlite_petsc.studies.cases import STEEL
from pearlite_petsc.tessellation.mesh import Mesh

GROWTH = 1.15
"""Each cell over its neighbour on the fine side."""


def graded_lines(extent: float, first: float, last: float, step: float) -> FloatArray:
    """Return grid lines from 0 to an extent, equally spaced between two places [um].

    Args:
        extent: Of the window [um].
        first, last: Ends of the fine part [um].
        step: Spacing there [um].
    """

    def outwards(gap: float) -> FloatArray:
        count = int(np.ceil(np.log1p(gap * (GROWTH - 1.0) / step) / np.log(GROWTH)))
        lines = np.cumsum(GROWTH ** np.arange(count))
        return np.asarray(lines * gap / lines[-1])

    fine = np.linspace(first, last, round((last - first) / step) + 1)
    below, above = first - outwards(first)[::-1], last + outwards(extent - last)
    below[0] = 0.0
    return np.concatenate([below, fine, above])


def straight_body(half: float, cell: float, width: float, height: float) -> tuple[Mesh, BoolArray]:
    """Return a plate with a centre crack along x, and the interfaces that the crack has broken.

    Args:
        half: Half length of the crack [um].
        cell: Width of the square cells along it [um].
        width, height: Of the plate [um].
    """
    x, y = 0.5 * width, 0.5 * height
    margin = 10.0 * cell
    points = tensor_points(
        graded_lines(width, x - half - margin, x + half + margin, cell),
        graded_lines(height, y - margin, y + margin, cell),
    )
    mesh = plain_mesh(points, width, height, largest=0.2 * height)
    return mesh, crossed(mesh, np.array([[x - half, y], [x + half, y]]))


def kinked_body(
    angle: float, kink: float, cell: float, size: float
) -> tuple[Mesh, BoolArray, tuple[float, float]]:
    """Return a square window whose crack runs from the left to the middle and kinks there.

    Nuclei stand in mirrored pairs along the crack, so that facets lie exactly on it.

    Args:
        angle: Of the kink, counter-clockwise from x [rad].
        kink: Its length [um].
        cell: Spacing of the nuclei round it [um].
        size: Of the window [um].

    Returns:
        The mesh, the interfaces that the crack has broken, and its tip [um].
    """
    middle = 0.5 * size
    direction = np.array([np.cos(angle), np.sin(angle)])
    corner = np.array([middle, middle])
    tip = corner + kink * direction
    lines = graded_lines(size, middle - 2.0 * kink, middle + 2.0 * kink, cell)
    grid = tensor_points(lines, lines)
    # Some pairs ahead of the tip, so that the crack could go on straight.
    paired = np.stack([corner - [1.9 * kink, 0.0], corner, tip, tip + 6.0 * cell * direction])
    points = np.concatenate(
        [grid[_distance(grid, paired) > 0.95 * cell], _mirrored_pairs(paired, cell)]
    )
    mesh = plain_mesh(points, size, size, largest=0.2 * size)
    crack = np.stack([np.array([0.0, middle]), corner, tip])
    return mesh, crossed(mesh, crack), (float(tip[0]), float(tip[1]))


def crossed(mesh: Mesh, path: FloatArray) -> BoolArray:
    """Return the interfaces between elements whose centres a path separates; (k,).

    Args:
        mesh: The mesh.
        path: Vertices of the path [um]; (p, 2).
    """
    here, there = np.swapaxes(mesh.centre[mesh.interface_elements], 0, 1)
    found = np.zeros(mesh.interface_count, dtype=np.bool_)
    for start, end in itertools.pairwise(path):
        parts = _side(start, end, here) * _side(start, end, there) < 0.0
        meets = _side(here, there, start) * _side(here, there, end) <= 0.0
        found |= parts & meets
    return found


def displacements(mesh: Mesh, broken: BoolArray, loads: Sequence[AiryFunction]) -> list[FloatArray]:
    """Return the displacement of the elements under each of some loads [um]; (n, 2) each."""
    subdomain = subdomain_of(mesh, spring_stiffness(mesh, STEEL), 0, mesh.element_count)
    settings = Solver("factors", 1e-10, 1)
    with Equilibrium(MPI.COMM_SELF, subdomain, broken.astype(float), settings) as equilibrium:
        return [
            equilibrium.solve(load_vector(mesh, airy) * [1.0, 1.0, subdomain.rotation_length])[
                :, :2
            ]
            for airy in loads
        ]


def _side(start: FloatArray, end: FloatArray, points: FloatArray) -> FloatArray:
    """Return twice the area of the triangles from start over end to points, signed [um^2]."""
    way, gap = end - start, points - start
    return np.asarray(way[..., 0] * gap[..., 1] - way[..., 1] * gap[..., 0])


def _distance(points: FloatArray, path: FloatArray) -> FloatArray:
    nearest = np.full(len(points), np.inf)
    for start, end in itertools.pairwise(path):
        way = end - start
        along = np.clip((points - start) @ way / (way @ way), 0.0, 1.0)
        gap = points - start - along[:, None] * way
        nearest = np.minimum(nearest, np.hypot(*gap.T))
    return nearest


def _mirrored_pairs(path: FloatArray, cell: float) -> FloatArray:
    pairs = []
    for start, end in itertools.pairwise(path):
        length = float(np.hypot(*(end - start)))
        direction = (end - start) / length
        count = max(round(length / cell), 1)
        along = (np.arange(count) + 0.5) * length / count
        across = 0.5 * cell * np.array([-direction[1], direction[0]])
        middle = start + along[:, None] * direction
        pairs += [middle + across, middle - across]
    return np.concatenate(pairs)
