"""The wake of a crack: simplified lines, facets on them, ends that keep their place."""

from itertools import pairwise

import numpy as np
import pytest

from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.build import initial_zone, prepare, tessellate
from pearlite_petsc.tessellation.wake import Wake, segment_distance, simplified, wake_of
from pearlite_petsc.tessellation.wake_facets import run_ends
from pearlite_petsc.tessellation.zone import NOWHERE
from tests.scenes import STATES, default_scene

SCENE = default_scene(elements={"radius": 18.0, "wake": "coarse"})
SUBSTRATE = prepare(SCENE, STATES["moderate_AT"], 0)
ZONE = NOWHERE.with_discs(np.array([[160.0, 110.0]]), 18.0)
NOTCH = tessellate(SUBSTRATE, initial_zone(SCENE)).notch


def bent_run() -> np.ndarray:
    """Return a crack that goes up by 10 um in zigzags of 1 um over 50 um, some way from the notch."""
    x = np.linspace(92.0, 142.0, 40)
    y = np.interp(x, [92.0, 120.0, 142.0], [100.0, 110.0, 110.0])
    zigzag = np.where(np.arange(40) % 2, 0.5, -0.5)
    zigzag[[0, -1]] = 0.0
    return np.column_stack([x, y + zigzag])


def wake_of_bent_run() -> Wake:
    return wake_of([bent_run()], np.array([NOTCH]))


def test_simplified_line_keeps_its_ends_and_every_points_tolerance() -> None:
    rng = np.random.default_rng(3)
    points = np.cumsum(rng.random((200, 2)) - [0.0, 0.5], axis=0)
    tolerance = np.linspace(4.0, 0.3, 200)
    line = simplified(points, tolerance)
    assert np.array_equal(line[[0, -1]], points[[0, -1]])
    gaps = [segment_distance(points, a, b) for a, b in pairwise(line)]
    assert (np.min(gaps, axis=0) <= tolerance).all()
    first_half = (line[:, 0] < points[100, 0]).sum()
    assert first_half < len(line) - first_half < 100


def test_facets_of_a_wake_are_one_chain_from_end_to_end() -> None:
    wake = wake_of_bent_run()
    mesh = tessellate(SUBSTRATE, ZONE, wake=wake)
    cut = (mesh.kind == Kind.NOTCH) & ~(mesh.vertices[mesh.interface_vertices, 1] == 100.0).all(
        axis=1
    )
    ends = mesh.junction[mesh.interface_vertices[cut]].ravel()
    junctions, uses = np.unique(ends, return_counts=True)
    assert set(junctions[uses == 1].tolist()) == set(run_ends(mesh, wake)[0])
    assert (uses[uses != 1] == 2).all()
    assert mesh.notch == NOTCH


def test_facets_of_a_wake_lie_on_its_line_where_nuclei_stand_in_pairs() -> None:
    ends = np.array([[92.0, 102.0], [140.0, 110.0]])
    straight = ends[0] + np.linspace(0.0, 1.0, 30)[:, None] * (ends[1] - ends[0])
    mesh = tessellate(SUBSTRATE, ZONE, wake=wake_of([straight], np.array([NOTCH])))
    cut = (mesh.kind == Kind.NOTCH) & (mesh.midpoint[:, 0] > 90.0)
    corners = mesh.vertices[mesh.interface_vertices[cut]]
    off = segment_distance(corners.reshape(-1, 2), *ends).reshape(-1, 2).max(axis=1)
    assert mesh.length[cut][off < 1e-6].sum() > 0.8 * np.hypot(*(ends[1] - ends[0]))
    assert mesh.length[cut].sum() < 1.1 * np.hypot(*(ends[1] - ends[0]))


def test_nuclei_along_a_wake_leave_vertices_that_stay_in_their_place() -> None:
    fine = tessellate(SUBSTRATE, NOWHERE.with_discs(np.array([[110.0, 105.0]]), 60.0))
    near = np.flatnonzero(np.hypot(*(fine.midpoint - [112.0, 110.0]).T) < 3.0)
    vertices = np.unique(fine.interface_vertices[near])
    around = np.isin(fine.vertex_indices, vertices)
    element = np.repeat(np.arange(fine.element_count), np.diff(fine.offsets))
    keep = np.unique(fine.nucleus[element[around]])
    fixed = fine.vertices[vertices]
    wake = wake_of_bent_run()
    runs = Wake(wake.points, wake.offsets, wake.stay, fixed, wake.pairs)
    mesh = tessellate(SUBSTRATE, ZONE, keep, runs)
    gap = np.linalg.norm(mesh.vertices[:, None] - fixed, axis=2).min(axis=0)
    assert len(near) > 3 and gap.max() < 1e-9
    assert (mesh.nucleus < 0).any() and mesh.element_count < fine.element_count


def test_elements_of_a_wake_stay_fine_round_what_holds_and_coarsen_elsewhere() -> None:
    holding = np.array([[112.0, 122.0]])
    wakes = [
        wake_of([bent_run()], stay) for stay in (np.array([NOTCH]), np.vstack([NOTCH, holding]))
    ]
    plain, mesh = (tessellate(SUBSTRATE, ZONE, wake=wake) for wake in wakes)
    count = [int((np.hypot(*(m.centre - holding[0]).T) < 6.0).sum()) for m in (plain, mesh)]
    assert count[1] > 3 * count[0] and count[1] > 8


@pytest.mark.parametrize("count", [0, 1])
def test_wake_without_a_run_cuts_nothing(count: int) -> None:
    wake = wake_of([np.array([NOTCH])] * count, np.empty((0, 2)))
    mesh, plain = tessellate(SUBSTRATE, ZONE, wake=wake), tessellate(SUBSTRATE, ZONE)
    assert np.array_equal(mesh.kind, plain.kind) and np.array_equal(mesh.nucleus, plain.nucleus)
