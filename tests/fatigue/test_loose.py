import numpy as np
import pytest

from pearlite_petsc.arrays import BoolArray
from pearlite_petsc.errors import SolverError
from pearlite_petsc.fatigue.loose import LooseClusters
from pearlite_petsc.studies.bodies import plain_mesh, random_points
from pearlite_petsc.tessellation.mesh import Mesh

MESH = plain_mesh(random_points(150, 12.0, 12.0, seed=13), 12.0, 12.0)
INNER = np.setdiff1d(np.arange(MESH.element_count), MESH.boundary_elements)


def components(mesh: Mesh, broken: BoolArray) -> list[int]:
    """Return the cluster of each element by spreading the smallest number."""
    label = list(range(mesh.element_count))
    pairs = mesh.interface_elements[~broken].tolist()
    changed = True
    while changed:
        changed = False
        for i, j in pairs:
            low = min(label[i], label[j])
            if label[i] != low or label[j] != low:
                label[i] = label[j] = low
                changed = True
    return label


def round_about(mesh: Mesh, elements: set[int]) -> list[int]:
    """Return the interfaces between some elements and all others."""
    inside = np.isin(mesh.interface_elements, list(elements))
    return np.flatnonzero(inside[:, 0] != inside[:, 1]).tolist()


def test_an_element_is_loose_when_the_last_of_its_interfaces_breaks_and_not_before() -> None:
    element = int(INNER[len(INNER) // 2])
    ring = round_about(MESH, {element})
    broken = np.zeros(MESH.interface_count, dtype=bool)
    clusters = LooseClusters(MESH, broken)
    for place, interface in enumerate(ring):
        assert not clusters.loose.any(), place
        broken[interface] = True
        clusters.add(np.array([interface]))
    assert np.flatnonzero(clusters.loose).tolist() == [element]


def test_loose_elements_are_those_outside_the_largest_cluster_after_every_break() -> None:
    rng = np.random.default_rng(3)
    inner = np.isin(MESH.interface_elements, INNER).all(axis=1)
    order = rng.permutation(np.flatnonzero(inner))[: int(0.7 * inner.sum())]
    broken = np.zeros(MESH.interface_count, dtype=bool)
    clusters = LooseClusters(MESH, broken)
    for step in np.array_split(order, 25):
        broken[step] = True
        clusters.add(step)
        label = components(MESH, broken)
        main = max(set(label), key=label.count)
        assert [item != main for item in label] == clusters.loose.tolist()
    assert clusters.loose.sum() > 5


def test_starting_from_broken_interfaces_finds_what_is_loose_already() -> None:
    chosen = {int(INNER[10]), int(INNER[11])}
    broken = np.zeros(MESH.interface_count, dtype=bool)
    broken[round_about(MESH, chosen)] = True
    assert set(np.flatnonzero(LooseClusters(MESH, broken).loose).tolist()) == chosen


def test_an_open_crack_from_the_boundary_loosens_nothing() -> None:
    x = MESH.midpoint[:, 0]
    crossing = MESH.centre[MESH.interface_elements][:, :, 1] > 6.0
    broken = (crossing[:, 0] != crossing[:, 1]) & (x < 8.0)
    assert broken.sum() > 5
    assert not LooseClusters(MESH, broken).loose.any()


def test_cutting_off_a_loaded_corner_is_an_error_that_names_the_element() -> None:
    corner = int(np.argmin(MESH.centre.sum(axis=1)))
    ring = round_about(MESH, {corner})
    broken = np.zeros(MESH.interface_count, dtype=bool)
    clusters = LooseClusters(MESH, broken)
    broken[ring] = True
    with pytest.raises(SolverError, match=f"element {corner} .*boundary load"):
        clusters.add(np.array(ring))
