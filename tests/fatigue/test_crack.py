import heapq
import math

import numpy as np
import pytest

from pearlite_petsc.fatigue.crack import LIGAMENT_DETOUR, CrackTracker
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.solver.subdomain import subdomain_of
from pearlite_petsc.studies.bodies import plain_mesh, random_points
from pearlite_petsc.tessellation.build import build_mesh
from pearlite_petsc.tessellation.mesh import Mesh
from tests.scenes import STATES, default_scene

MESH = plain_mesh(random_points(220, 20.0, 20.0, seed=21), 20.0, 20.0)
ENDS = MESH.junction[MESH.interface_vertices]
# Points on the window's edge share one x: there the first to be reached is the tip.
INNER = np.flatnonzero(MESH.vertices[MESH.interface_vertices, 0].max(axis=1) < 20.0)
ROOT = int(np.argmin(np.hypot(*(MESH.vertices - [6.0, 10.0]).T)))


def add(tracker: CrackTracker, mesh: Mesh, chosen: list[int], notch: bool = False) -> list:
    junctions = mesh.junction[mesh.interface_vertices[chosen]]
    return tracker.add(
        mesh.interface_elements[chosen],
        junctions,
        mesh.vertices[mesh.interface_vertices[chosen]],
        notch=notch,
    )


def started() -> CrackTracker:
    x, y = MESH.vertices[ROOT].tolist()
    return CrackTracker((x, y), ROOT)


def shortest(chosen: list[int]) -> dict[int, float]:
    """Ways from the root over a graph built anew: broken interfaces, and detours over elements."""
    edges: dict[int, list[tuple[int, float]]] = {}
    of_element: dict[int, set[int]] = {}

    def join(a: int, b: int, factor: float) -> None:
        step = factor * math.dist(MESH.vertices[a], MESH.vertices[b])
        edges.setdefault(a, []).append((b, step))
        edges.setdefault(b, []).append((a, step))

    for interface in chosen:
        a, b = ENDS[interface].tolist()
        join(a, b, 1.0)
        for element in MESH.interface_elements[interface].tolist():
            of_element.setdefault(element, set()).update((a, b))
    for junctions in of_element.values():
        for a in junctions:
            for b in junctions:
                if a < b:
                    join(a, b, LIGAMENT_DETOUR)
    cost, queue = {ROOT: 0.0}, [(0.0, ROOT)]
    while queue:
        so_far, junction = heapq.heappop(queue)
        if so_far > cost[junction]:
            continue
        for other, step in edges.get(junction, []):
            if so_far + step < cost.get(other, math.inf):
                cost[other] = so_far + step
                heapq.heappush(queue, (cost[other], other))
    return cost


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_tip_and_reach_are_those_of_a_search_from_scratch(seed: int) -> None:
    rng = np.random.default_rng(seed)
    order = rng.permutation(INNER)[: len(INNER) // 2].tolist()
    tracker = started()
    reached = {tuple(MESH.vertices[ROOT].tolist())}
    for count, interface in enumerate(order, 1):
        reached |= set(add(tracker, MESH, [interface]))
        if count % 40 and count != len(order):
            continue
        cost = shortest(order[:count])
        points = {tuple(MESH.vertices[junction].tolist()) for junction in cost}
        assert reached == points
        assert tracker.tip == max(points)
        assert tracker.broken == count


def test_the_order_of_breaks_changes_no_bit_where_vertices_share_a_junction() -> None:
    mesh = build_mesh(default_scene(), STATES["severe_AT"], 1)
    stiffness = spring_stiffness(mesh, default_scene().material)
    interfaces = subdomain_of(mesh, stiffness, 0, mesh.element_count).interfaces
    shared = np.flatnonzero(np.bincount(mesh.junction, minlength=len(mesh.vertices)) > 1)
    assert len(shared) > 3
    near = np.isin(interfaces.junctions, shared).any(axis=1)
    assert (interfaces.ends[near] != mesh.vertices[mesh.interface_vertices[near]]).any()
    rng = np.random.default_rng(1)
    root = int(mesh.junction[np.argmin(np.hypot(*(mesh.vertices - mesh.notch).T))])
    chosen = np.flatnonzero(interfaces.fine & (rng.random(len(interfaces.fine)) < 0.7))
    lengths = set()
    for _ in range(20):
        tracker = CrackTracker(tuple(mesh.vertices[root].tolist()), root)
        order = rng.permutation(chosen)
        tracker.add(interfaces.elements[order], interfaces.junctions[order], interfaces.ends[order])
        lengths.add((tracker.tip, tracker.path_length))
    assert tracker.path_length > 10.0
    assert len(lengths) == 1


@pytest.mark.parametrize("seed", [1, 2, 4])
def test_the_tip_after_a_break_is_foreseen(seed: int) -> None:
    order = np.random.default_rng(seed).permutation(INNER)[: len(INNER) // 2].tolist()
    tracker = started()
    moved = 0
    for interface in order:
        junctions = MESH.junction[MESH.interface_vertices[interface]].tolist()
        ends = MESH.vertices[MESH.interface_vertices[interface]].tolist()
        before = tracker.tip
        foreseen = tracker.tip_after((MESH.interface_elements[interface].tolist(), junctions, ends))
        assert tracker.tip == before
        add(tracker, MESH, [interface])
        assert tracker.tip == foreseen
        moved += tracker.tip != before
    assert moved > 3


def test_the_path_is_the_shortest_way_whatever_the_order_of_breaks() -> None:
    rng = np.random.default_rng(5)
    chosen = rng.permutation(INNER)[:300]
    lengths = []
    for order in (chosen, chosen[::-1], rng.permutation(chosen)):
        tracker = started()
        add(tracker, MESH, order.tolist())
        crack = tracker.crack()
        steps = np.hypot(*np.diff(crack.path, axis=0).T)
        assert crack.path_length == pytest.approx(steps.sum())
        assert crack.path[0].tolist() == MESH.vertices[ROOT].tolist()
        assert tuple(crack.path[-1]) == crack.tip == (crack.length, crack.tip[1])
        lengths.append(crack.path_length)
    assert lengths == pytest.approx([lengths[0]] * 3)


def line(points: list[tuple[float, float]]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Interfaces between successive points, each between elements of its own."""
    count = len(points) - 1
    pairs = np.arange(2 * count).reshape(-1, 2)
    junctions = np.stack([np.arange(count), np.arange(1, count + 1)], axis=1)
    ends = np.array([points[:-1], points[1:]], dtype=float).transpose(1, 0, 2)
    return pairs, junctions, ends


def test_a_straight_crack_is_as_long_as_its_interfaces() -> None:
    tracker = CrackTracker((0.0, 0.0), 0)
    reached = tracker.add(*line([(0.0, 0.0), (1.0, 0.0), (3.0, 0.0), (3.0, 4.0)]))
    assert reached == [(1.0, 0.0), (3.0, 0.0), (3.0, 4.0)]
    crack = tracker.crack()
    assert (crack.length, crack.path_length, crack.broken) == (3.0, 3.0, 3)
    # The tip is the first to have come so far; equal x does not move it.
    assert crack.tip == (3.0, 0.0)


def test_a_crack_of_its_own_counts_only_once_it_is_joined() -> None:
    pairs, junctions, ends = line([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (5.0, 0.0)])
    tracker = CrackTracker((0.0, 0.0), 0)
    assert tracker.add(pairs[2:], junctions[2:], ends[2:]) == []
    assert tracker.tip == (0.0, 0.0) and tracker.broken == 1
    tracker.add(pairs[:1], junctions[:1], ends[:1])
    assert tracker.tip == (1.0, 0.0)
    assert tracker.add(pairs[1:2], junctions[1:2], ends[1:2]) == [(2.0, 0.0), (5.0, 0.0)]
    assert tracker.tip == (5.0, 0.0) and tracker.path_length == 5.0


def test_the_notch_is_no_growth() -> None:
    tracker = CrackTracker((0.0, 0.0), 0)
    pairs, junctions, ends = line([(0.0, 0.0), (-2.0, 0.0), (-4.0, 0.0)])
    tracker.add(pairs, junctions, ends, notch=True)
    crack = tracker.crack()
    assert (crack.length, crack.path_length, crack.broken, len(crack.path)) == (0.0, 0.0, 0, 1)


def test_a_ligament_of_one_element_belongs_to_the_crack_but_the_path_goes_round_it() -> None:
    tracker = CrackTracker((0.0, 0.0), 0)
    # Element 7 has broken interfaces on both sides of an unbroken one from x = 1 to 2.
    pairs = np.array([[7, 8], [7, 9]])
    ends = np.array([[[0.0, 0.0], [1.0, 0.0]], [[2.0, 0.0], [3.0, 0.0]]])
    tracker.add(pairs, np.array([[0, 1], [2, 3]]), ends)
    assert tracker.tip == (3.0, 0.0) and tracker.path_length == 3.0
    # A way round along broken interfaces, longer than the ligament but shorter than its detour.
    around = np.array([[[1.0, 0.0], [1.5, 2.0]], [[1.5, 2.0], [2.0, 0.0]]])
    tracker.add(np.array([[20, 21], [22, 23]]), np.array([[1, 9], [9, 2]]), around)
    assert tracker.path_length == pytest.approx(2.0 + 2 * math.hypot(0.5, 2.0))
    assert [1.5, 2.0] in tracker.crack().path.tolist()
