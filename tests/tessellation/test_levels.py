import numpy as np
from scipy.spatial import cKDTree

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.tessellation.curve import hilbert_order
from pearlite_petsc.tessellation.levels import GROWTH, coarsening_levels, level_of


def lattice() -> FloatArray:
    x, y = np.meshgrid(np.arange(60.0), np.arange(60.0))
    return np.column_stack([x.ravel(), y.ravel()])


def test_each_level_is_sparser_by_the_square_root_of_two() -> None:
    points = lattice()
    priority = np.random.default_rng(1).random(len(points))
    none = np.full(len(points), -1)
    level = coarsening_levels(points, none, priority, 1.0, 8.0)
    assert level.max() == 6
    for step in range(1, 7):
        kept = points[level >= step]
        spacing = np.sqrt(3600 / len(kept))
        assert 0.85 < spacing / GROWTH**step < 1.3
        assert cKDTree(kept).query(kept, k=2)[0][:, 1].min() >= 0.7 * GROWTH**step


def test_no_place_is_left_without_a_nucleus_of_each_level() -> None:
    points = lattice()
    level = coarsening_levels(
        points, np.full(len(points), -1), np.random.default_rng(2).random(len(points)), 1.0, 8.0
    )
    for step in range(1, 7):
        gap = cKDTree(points[level >= step]).query(points)[0]
        # Each level leaves out only what is near its own: the gaps add up as a geometric series.
        assert gap.max() <= 0.72 * sum(GROWTH**k for k in range(1, step + 1))


def test_mirror_pairs_vanish_together() -> None:
    upper = lattice()[:, ::-1] + [0.0, 0.5]
    points = np.concatenate([upper, upper * [1, -1]])
    n = len(upper)
    partner = np.concatenate([np.arange(n) + n, np.arange(n)])
    priority = np.tile(np.random.default_rng(3).random(n), 2)
    level = coarsening_levels(points, partner, priority, 1.0, 8.0)
    assert np.array_equal(level[:n], level[n:])
    assert len(np.unique(level)) == 7


def test_the_level_of_a_spacing_never_exceeds_it() -> None:
    factor = np.array([1.0, 1.41, GROWTH, 1.99, 2.0, 5.0, 1e9])
    assert level_of(factor, 8.0).tolist() == [0, 0, 1, 1, 2, 4, 6]
    assert level_of(factor, 1.0).tolist() == [0] * 7


def test_hilbert_order_of_a_power_of_two_square_walks_from_neighbour_to_neighbour() -> None:
    x, y = np.meshgrid(np.arange(16.0), np.arange(16.0))
    points = np.column_stack([x.ravel(), y.ravel()])
    points = np.concatenate([points, [[15.999, 15.999]]])
    walk = points[hilbert_order(points)]
    walk = walk[walk[:, 0] != 15.999]
    assert np.allclose(np.abs(np.diff(walk, axis=0)).sum(axis=1), 1.0)
