import numpy as np
from scipy.spatial import cKDTree

from pearlite_petsc.microstructure.hard_core import (
    conflicting_pairs,
    hard_core_points,
    independent_subset,
)


def greedy(pairs: np.ndarray, priority: np.ndarray) -> np.ndarray:
    """Scalar twin: one thing after the other."""
    chosen = np.zeros(len(priority), dtype=bool)
    for i in np.argsort(priority):
        conflicts = [int(a + b - i) for a, b in pairs if i in (a, b)]
        chosen[i] = not any(chosen[j] for j in conflicts)
    return chosen


def test_the_vectorised_choice_is_the_sequential_greedy_one() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        points = rng.random((60, 2))
        pairs = conflicting_pairs(points, 0.2)
        priority = rng.permutation(60).astype(float)
        assert np.array_equal(independent_subset(pairs, priority), greedy(pairs, priority))


def test_without_conflicts_everything_is_chosen() -> None:
    assert independent_subset(np.empty((0, 2), dtype=np.int64), np.arange(5.0)).all()


def test_no_two_hard_core_points_are_too_close_in_the_mapped_region() -> None:
    shear = np.array([[1.0, -30.0], [0.0, 1.0]])
    points = hard_core_points((0, 0, 200, 200), shear, 0.02, 7.0, np.random.default_rng(2))
    assert len(points) > 300
    assert cKDTree(points).query(points, k=2)[0][:, 1].min() >= 7.0
    box = points @ np.linalg.inv(shear).T
    assert ((box >= 0) & (box <= 200)).all()
