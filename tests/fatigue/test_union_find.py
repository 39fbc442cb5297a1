import numpy as np

from pearlite_petsc.fatigue.union_find import UnionFind


def test_sets_are_those_of_painting_numbers_over() -> None:
    rng = np.random.default_rng(4)
    sets, colour = UnionFind(), list(range(60))
    for a, b in rng.integers(0, 60, size=(80, 2)).tolist():
        apart = colour[a] != colour[b]
        assert sets.join(a, b) == apart
        colour = [colour[b] if c == colour[a] else c for c in colour]
        for item in range(60):
            assert (sets.find(item) == sets.find(a)) == (colour[item] == colour[a])


def test_a_number_never_seen_is_alone() -> None:
    sets = UnionFind()
    assert sets.find(7) == 7
    assert sets.join(7, 8)
    assert not sets.join(8, 7)
    assert not sets.join(7, 7)


def test_a_long_chain_is_no_deep_recursion() -> None:
    sets = UnionFind()
    for item in range(20_000):
        sets.join(item, item + 1)
    assert sets.find(0) == sets.find(20_000)
