from functools import cache

import numpy as np
import pytest

from pearlite_petsc.errors import MeshError
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.assemble import DROPPING
from pearlite_petsc.tessellation.build import (
    Substrate,
    build_mesh,
    prepare,
    tessellate,
)
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.quality import quality
from pearlite_petsc.tessellation.zone import AHEAD, FineZone, initial_zone
from tests.scenes import STATES, default_scene
from tests.tessellation.closure import outward_sums

SCENE = default_scene()
NO_BOXES, NO_DISCS = np.empty((0, 4)), np.empty((0, 3))
EVERYWHERE = FineZone(np.array([[0.0, 0.0, 200.0, 200.0]]), NO_DISCS)
every_state = pytest.mark.parametrize("name", STATES)


@cache
def substrate(name: str, index: int = 0) -> Substrate:
    return prepare(SCENE, STATES[name], index)


@cache
def mesh(name: str, index: int = 0) -> Mesh:
    return tessellate(substrate(name, index), initial_zone(SCENE))


@cache
def uniform(name: str) -> Mesh:
    return tessellate(substrate(name), EVERYWHERE)


@every_state
def test_elements_fill_the_window_and_their_outward_normals_cancel(name: str) -> None:
    m = uniform(name)
    assert abs(m.area.sum() - 40_000.0) < 1e-6
    outward = outward_sums(m)
    # A dropped facet is missing in the sum; nothing else may be.
    assert np.abs(outward).max() < 4 * DROPPING * np.sqrt(8.0)
    assert np.median(np.abs(outward)) < 1e-12


@every_state
def test_interfaces_are_perpendicular_to_the_line_of_centres_and_half_way(name: str) -> None:
    m = mesh(name)
    i, j = m.interface_elements.T
    assert (i < j).all()
    gap = m.centre[j] - m.centre[i]
    assert np.allclose(gap, m.normal * np.hypot(*gap.T)[:, None], rtol=0, atol=1e-12)
    start, end = m.vertices[m.interface_vertices].transpose(1, 0, 2)
    assert np.abs(((end - start) * m.normal).sum(axis=1)).max() < 1e-8
    assert (m.normal[:, 0] * (end - start)[:, 1] > m.normal[:, 1] * (end - start)[:, 0]).all()
    middle = 0.5 * (m.centre[i] + m.centre[j])
    assert np.abs(((m.midpoint - middle) * m.normal).sum(axis=1)).max() < 1e-8
    assert np.allclose(m.length, np.hypot(*(end - start).T), rtol=1e-12)
    assert m.length.min() >= DROPPING * np.sqrt(8.0)


@every_state
def test_polygons_are_convex_counter_clockwise_and_hold_their_nucleus(name: str) -> None:
    m = mesh(name)
    for element in range(m.element_count):
        corners = m.vertices[m.vertex_indices[m.offsets[element] : m.offsets[element + 1]]]
        step = np.roll(corners, -1, axis=0) - corners
        turn = step[:, 0] * np.roll(step, -1, axis=0)[:, 1]
        turn -= step[:, 1] * np.roll(step, -1, axis=0)[:, 0]
        assert turn.min() > -1e-9
        inward = m.centre[element] - corners
        assert (step[:, 0] * inward[:, 1] - step[:, 1] * inward[:, 0]).min() > 0


@every_state
@pytest.mark.parametrize("index", range(4))
def test_the_notch_is_one_straight_run_from_the_edge_to_its_tip(name: str, index: int) -> None:
    m = mesh(name, index)
    notch = m.kind == Kind.NOTCH
    ends = np.sort(m.vertices[m.interface_vertices[notch]][:, :, 0], axis=1)
    ends = ends[ends[:, 0].argsort()]
    assert (m.vertices[m.interface_vertices[notch]][:, :, 1] == 100.0).all()
    assert ends[0, 0] == 0.0
    assert (ends[1:, 0] - ends[:-1, 1]).max() < 1e-2
    assert m.notch == (ends[-1, 1], 100.0)
    assert abs(m.notch[0] - 80.0) < SCENE.elements.length


def test_the_notch_is_followed_where_the_nearest_nucleus_has_no_mirror_image() -> None:
    # Here the coarse nuclei left at the notch let one beyond the band come closest to its line.
    scene = default_scene(elements={"width": 4.0, "length": 4.0, "radius": 24.0})
    part = prepare(scene, STATES["severe_AT"], 15)
    m = tessellate(part, initial_zone(scene))
    assert abs(m.notch[0] - 80.0) < 4.0
    notch = m.kind == Kind.NOTCH
    assert abs(m.length[notch].sum() - m.notch[0]) < 0.1
    paired = part.partner[m.nucleus[m.interface_elements[notch]]]
    assert np.array_equal(paired[:, 0], m.nucleus[m.interface_elements[notch, 1]])


def test_the_notch_stays_where_it_is_under_any_grading() -> None:
    rng = np.random.default_rng(1)
    for name in STATES:
        for _ in range(5):
            discs = np.column_stack([rng.random((4, 2)) * 200, np.full(4, 10.0)])
            graded = tessellate(substrate(name), FineZone(NO_BOXES, discs))
            assert abs(graded.notch[0] - uniform(name).notch[0]) < 1e-9


def test_a_graded_mesh_takes_its_nuclei_from_the_fine_one() -> None:
    coarse, fine = mesh("undeformed"), uniform("undeformed")
    assert coarse.element_count < 0.15 * fine.element_count
    assert np.array_equal(fine.nucleus, np.arange(fine.element_count))
    assert np.array_equal(coarse.centre, fine.centre[coarse.nucleus])
    assert np.array_equal(coarse.colony, fine.colony[coarse.nucleus])
    assert np.array_equal(coarse.lamella_angle, fine.lamella_angle[coarse.nucleus])
    ahead = 80.0 + AHEAD * SCENE.elements.radius
    inside = np.hypot(*(fine.centre - [ahead, 100.0]).T) <= SCENE.elements.radius
    assert np.isin(np.flatnonzero(inside), coarse.nucleus).all()
    assert coarse.fine.sum() == inside.sum()


def test_interfaces_deep_in_the_fine_zone_are_those_of_the_uniform_mesh() -> None:
    zone = FineZone(NO_BOXES, np.array([[120.0, 80.0, 25.0]]))
    graded, fine = tessellate(substrate("moderate_AT"), zone), uniform("moderate_AT")
    found = []
    for m in (graded, fine):
        deep = np.hypot(*(m.midpoint - [120.0, 80.0]).T) < 15.0
        pairs = m.nucleus[m.interface_elements[deep]]
        order = np.lexsort(pairs.T)
        found.append((pairs[order], m.length[deep][order], m.kind[deep][order]))
    assert len(found[0][0]) > 150
    assert np.array_equal(found[0][0], found[1][0])
    assert np.allclose(found[0][1], found[1][1], rtol=0, atol=1e-9)
    assert np.array_equal(found[0][2], found[1][2])


def test_uniform_refinement_is_fine_everywhere_whatever_the_zone() -> None:
    scene = default_scene(elements={"refinement": "uniform"})
    part = prepare(scene, STATES["undeformed"], 0)
    zone = FineZone(NO_BOXES, np.array([[10.0, 10.0, 5.0]]))
    for chosen in (initial_zone(scene), zone):
        assert np.array_equal(tessellate(part, chosen).centre, uniform("undeformed").centre)


def test_elements_grow_with_the_distance_up_to_the_cap() -> None:
    m = mesh("undeformed")
    distance = initial_zone(SCENE).distance(m.centre)
    ahead = m.centre[:, 0] > 80.0
    means = [
        m.area[ahead & (distance > low) & (distance <= low + 20)].mean() for low in (0, 20, 40, 60)
    ]
    assert 8.0 < means[0] < means[1] < means[2] < means[3] < 1.5 * 64 * 8.0


def test_nuclei_to_keep_are_kept_with_their_mirror_images() -> None:
    part = substrate("undeformed")
    paired = np.flatnonzero(part.partner >= 0)
    keep = np.concatenate([paired[:3], np.array([0, 17, len(part.points) - 1])])
    kept = tessellate(part, initial_zone(SCENE), keep)
    assert np.isin(keep, kept.nucleus).all()
    assert np.isin(part.partner[paired[:3]], kept.nucleus).all()
    assert kept.element_count <= mesh("undeformed").element_count + 9


def test_kinds_follow_the_labels_and_the_direction_of_the_lamellae() -> None:
    by_labels = default_scene(elements={"kinds": "labels"})
    m = tessellate(prepare(by_labels, STATES["moderate_TA"], 0), EVERYWHERE)
    i, j = m.interface_elements.T
    kind = m.kind
    for name, label in (
        (Kind.COLONY, m.block),
        (Kind.BLOCK, m.prior_austenite_grain),
        (Kind.LAMELLA, m.colony),
        (Kind.CEMENTITE, m.colony),
    ):
        assert (label[i] == label[j])[kind == name].all()
    for name, label in (
        (Kind.COLONY, m.colony),
        (Kind.BLOCK, m.block),
        (Kind.PRIOR_AUSTENITE_GRAIN, m.prior_austenite_grain),
    ):
        assert (label[i] != label[j])[kind == name].all()
    for chosen, sign in ((Kind.LAMELLA, 1), (Kind.CEMENTITE, -1)):
        some = np.flatnonzero(kind == chosen)
        step = m.vertices[m.interface_vertices[some]]
        angle = np.arctan2(*(step[:, 1] - step[:, 0]).T[::-1]) - m.lamella_angle[i[some]]
        assert (sign * np.cos(2 * angle) > -1e-12).all()
        assert len(some) > 1000


def test_lamella_interfaces_are_long_and_cementite_interfaces_short() -> None:
    m = uniform("undeformed")
    assert abs(np.median(m.length[m.kind == Kind.LAMELLA]) - 4.0) < 0.1
    assert abs(np.median(m.length[m.kind == Kind.CEMENTITE]) - 2.0) < 0.05


def test_rows_of_a_severe_state_run_on_through_its_thin_colonies() -> None:
    # Colonies are half a micrometre thick here; independent lattices would give random cells.
    m = uniform("severe_AT")
    near = np.hypot(*(m.midpoint - [100.0, 100.0]).T) < 30.0
    flat = near & (np.abs(m.normal[:, 1]) > 0.98)
    assert m.length[flat].sum() > 0.5 * m.length[near].sum()
    assert quality(m, 80.0).area_spread < 0.25


@every_state
def test_elements_of_the_uniform_mesh_have_nearly_one_size(name: str) -> None:
    q = quality(uniform(name), 80.0)
    assert abs(q.equivalent_diameter / np.sqrt(8.0 * 4 / np.pi) - 1.0) < 0.07
    assert q.area_spread < 0.25
    assert q.dropped < 0.02 * q.interfaces
    assert abs(sum(q.kind_share.values()) - 1.0) < 1e-12


def test_a_mesh_is_the_same_every_time_and_differs_with_its_index() -> None:
    again = build_mesh(SCENE, STATES["severe_TA"], 0)
    for field in ("vertices", "interface_elements", "kind", "boundary_vertices"):
        assert np.array_equal(getattr(again, field), getattr(mesh("severe_TA"), field))
    assert not np.array_equal(mesh("severe_TA", 1).centre[:20], again.centre[:20])


def test_the_microstructure_does_not_depend_on_the_elements() -> None:
    coarser = default_scene(elements={"width": 3.0, "length": 3.0, "refinement": "corridor"})
    other = prepare(coarser, STATES["moderate_AT"], 0).label_map
    points = np.random.default_rng(4).random((500, 2)) * 200
    for a, b in zip(
        other.labels(points), substrate("moderate_AT").label_map.labels(points), strict=True
    ):
        assert np.array_equal(a, b)


def test_arrays_of_a_mesh_cannot_be_written() -> None:
    with pytest.raises(ValueError, match="read-only"):
        mesh("undeformed").length[0] = 1.0


def test_dropped_facets_join_their_ends() -> None:
    m = uniform("severe_AT")
    joined = np.flatnonzero(m.junction != np.arange(len(m.junction)))
    assert len(joined) > 5
    gap = np.hypot(*(m.vertices[joined] - m.vertices[m.junction[joined]]).T)
    assert gap.max() < 4 * DROPPING * np.sqrt(8.0)


def test_a_window_for_nine_elements_is_refused() -> None:
    tiny = default_scene(window={"width": 8.0, "height": 8.0, "notch": 3.0})
    with pytest.raises(MeshError, match="at least 10"):
        build_mesh(tiny, STATES["undeformed"], 0)


def test_a_negative_index_is_refused() -> None:
    with pytest.raises(MeshError, match="-1 is negative"):
        build_mesh(SCENE, STATES["undeformed"], -1)


def test_the_distance_to_a_zone_is_the_shortest_to_its_boxes_and_discs() -> None:
    zone = FineZone(np.array([[0.0, 0.0, 2.0, 1.0]]), np.array([[10.0, 0.0, 3.0]]))
    points = np.array([[1.0, 0.5], [5.0, 5.0], [6.0, 0.0], [14.0, 0.0], [12.9, 0.0]])
    assert np.allclose(zone.distance(points), [0.0, np.hypot(5, 5) - 3, 1.0, 1.0, 0.0])
    wider = zone.with_discs(np.array([[5.0, 5.0]]), 1.0)
    assert wider.distance(points)[1] == 0.0
