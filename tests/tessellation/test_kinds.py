"""Kinds by what facets cut: a slow twin of the rule, cases by hand, and what it promises."""

from dataclasses import replace
from functools import cache
from math import cos, pi, radians, sin, tan

import numpy as np
import pytest

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.microstructure.cells import window_cells
from pearlite_petsc.microstructure.labels import LabelMap, Level
from pearlite_petsc.microstructure.shear import deformation_gradient, sheared_angle
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.build import Substrate, prepare, tessellate
from pearlite_petsc.tessellation.kinds import SAMPLES, Facets, kinds_by_labels, shares_by_cut
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.zone import FineZone, initial_zone
from tests.scenes import STATES, default_scene

EVERYWHERE = FineZone(np.array([[0.0, 0.0, 90.0, 90.0]]), np.empty((0, 3)))
WINDOW = {"width": 90.0, "height": 90.0, "notch": 36.0}
every_state = pytest.mark.parametrize("name", STATES)
every_width = pytest.mark.parametrize("width", [1.5, 3.0])


@cache
def substrate(name: str, width: float = 2.0, shear: str = "remesh") -> Substrate:
    elements = {"width": width, "length": width, "kinds": "cut", "shear": shear}
    return prepare(default_scene(window=WINDOW, elements=elements), STATES[name], 0)


@cache
def mesh(name: str, width: float = 2.0, shear: str = "remesh") -> Mesh:
    return tessellate(substrate(name, width, shear), EVERYWHERE)


def facets_of(m: Mesh) -> Facets:
    i, j = m.interface_elements.T
    spacing = ((m.centre[j] - m.centre[i]) * m.normal).sum(axis=1)
    labels = (m.prior_austenite_grain, m.block, m.colony)
    pairs, ends = m.interface_elements, m.interface_vertices
    return Facets(m.vertices, ends, m.normal, pairs, spacing, labels, m.lamella_angle)


def two_colonies(boundary: float, lamellae: tuple[float, float], gamma: float = 0.0) -> LabelMap:
    """Return a map whose one boundary goes through (50, 50) at an angle, lamellae at others, degrees."""
    forward = deformation_gradient(gamma, "AT")
    normal = np.array([-sin(radians(boundary)), cos(radians(boundary))])
    middle = np.linalg.inv(forward) @ np.array([50.0, 50.0])
    seeds = np.stack([middle - 10.0 * normal, middle + 10.0 * normal])
    one, two = np.zeros(1, dtype=np.int64), np.zeros(2, dtype=np.int64)
    angle = np.radians(np.array(lamellae))
    single = Level.of(middle[None], one)
    return LabelMap(
        (single, single, Level.of(seeds, two)),
        sheared_angle(angle, forward),
        angle,
        forward,
        (100.0, 100.0),
    )


def one_facet(
    label_map: LabelMap,
    direction: float,
    length: float = 2.0,
    spacing: float = 2.0,
    off: float = 0.0,
) -> FloatArray:
    """Return the shares of a facet at an angle [degrees] through (50, 50 + off)."""
    along = np.array([cos(radians(direction)), sin(radians(direction))])
    normal = np.array([along[1], -along[0]])
    middle = np.array([50.0, 50.0 + off])
    vertices = middle + np.outer([-0.5, 0.5], length * along)
    centre = middle + np.outer([-0.5, 0.5], spacing * normal)
    labels = label_map.labels(centre)
    facets = Facets(
        vertices,
        np.array([[0, 1]]),
        normal[None],
        np.array([[0, 1]]),
        np.array([spacing]),
        labels,
        label_map.lamella_angle[labels[2]],
    )
    return np.asarray(shares_by_cut(facets, label_map)[0])


@pytest.mark.parametrize("turn", [0.0, 44.0, -44.0])
def test_a_boundary_that_runs_along_a_facet_makes_it_one(turn: float) -> None:
    # Lamellae that the facet would cut on both sides.
    shares = one_facet(two_colonies(20.0 + turn, (110.0, 115.0)), 20.0)
    assert shares.tolist() == [0.0, 0.0, 1.0, 0.0, 0.0]


@pytest.mark.parametrize("turn", [46.0, -46.0, 90.0])
def test_a_boundary_that_crosses_a_facet_leaves_it_to_the_lamellae(turn: float) -> None:
    cut = one_facet(two_colonies(20.0 + turn, (110.0, 115.0)), 20.0)
    along = one_facet(two_colonies(20.0 + turn, (20.0, 25.0)), 20.0)
    assert cut.tolist() == [0.0, 1.0, 0.0, 0.0, 0.0]
    assert along.tolist() == [1.0, 0.0, 0.0, 0.0, 0.0]


def test_a_facet_that_a_boundary_halves_cuts_cementite_on_one_half() -> None:
    shares = one_facet(two_colonies(90.0, (0.0, 90.0)), 0.0)
    assert shares.tolist() == [0.5, 0.5, 0.0, 0.0, 0.0]


def test_a_boundary_beyond_the_elements_centres_does_not_count() -> None:
    shares = one_facet(two_colonies(0.0, (90.0, 90.0)), 0.0, off=1.1)
    assert shares.tolist() == [0.0, 1.0, 0.0, 0.0, 0.0]
    assert one_facet(two_colonies(0.0, (90.0, 90.0)), 0.0, off=0.9)[Kind.COLONY] == 1.0


def test_shear_carries_boundaries_and_lamellae_along() -> None:
    gamma = 2.0
    upright = two_colonies(90.0, (90.0, 90.0), gamma)
    leaning = np.degrees(np.arctan2(1.0, gamma))
    assert one_facet(upright, leaning).tolist() == [0.0, 0.0, 1.0, 0.0, 0.0]
    assert one_facet(upright, leaning + 90.0)[Kind.CEMENTITE] == 1.0


def slow_shares(label_map: LabelMap, facets: Facets, number: int) -> FloatArray:
    """The rule for one facet, place by place."""
    start, end = facets.vertices[facets.ends[number]]
    normal, reach = facets.normal[number], 0.5 * facets.spacing[number]
    count = np.zeros(5)
    grains = label_map.labels(np.array([start, end]))[0].tolist()
    grains += facets.labels[0][facets.pairs[number]].tolist()
    known = np.array([grains[0] if len(set(grains)) == 1 else -1])
    for sample in range(SAMPLES):
        place = start + (sample + 0.5) / SAMPLES * (end - start)
        points = [(place + side * reach * normal)[None] for side in (-1, 1)]
        labels = [[int(label[0]) for label in label_map.labels(at, known)] for at in points]
        kind = None
        for level, boundary in enumerate((Kind.PRIOR_AUSTENITE_GRAIN, Kind.BLOCK, Kind.COLONY)):
            one, other = labels[0][level], labels[1][level]
            if one != other:
                seeds = label_map.levels[level].seeds
                line = np.array([[0.0, -1.0], [1.0, 0.0]]) @ (seeds[other] - seeds[one])
                line = label_map.deformation @ line
                facing = abs(normal @ line) / np.hypot(*line)
                kind = boundary if facing < sin(pi / 4) else None
                break
        for _, _, colony in labels:
            angle = label_map.lamella_angle[colony]
            across = abs(normal @ [cos(angle), sin(angle)]) > sin(pi / 4)
            count[kind if kind is not None else int(across)] += 0.5 / SAMPLES
    return count


@every_state
@pytest.mark.parametrize("shear", ["remesh", "affine"])
def test_the_shares_are_those_of_the_rule_written_out(name: str, shear: str) -> None:
    m, label_map = mesh(name, 2.0, shear), substrate(name, 2.0, shear).label_map
    facets = facets_of(m)
    shares = shares_by_cut(facets, label_map)
    inner = np.flatnonzero(m.kind != Kind.NOTCH)
    assert np.array_equal(shares[inner, Kind.CEMENTITE], m.cementite_share[inner])
    assert np.array_equal(shares[inner].argmax(axis=1), m.kind[inner])
    assert np.allclose(shares.sum(axis=1), 1.0, rtol=0, atol=1e-15)
    for number in np.random.default_rng(2).choice(inner, 60, replace=False).tolist():
        whole = _lies_in_one_colony(label_map, facets, number)
        if not whole:
            assert np.allclose(shares[number], slow_shares(label_map, facets, number), atol=1e-12)
        else:
            assert shares[number, kinds_by_labels(facets)[number]] == 1.0


def _lies_in_one_colony(label_map: LabelMap, facets: Facets, number: int) -> bool:
    colony = label_map.labels(facets.vertices[facets.ends[number]])[2].tolist()
    return len({*colony, *facets.labels[2][facets.pairs[number]].tolist()}) == 1


@every_state
@every_width
def test_no_facet_is_weak_that_cuts_lamellae_all_along_and_has_no_boundary_by_its_side(
    name: str, width: float
) -> None:
    label_map = substrate(name, width).label_map
    m = tessellate(substrate(name, width), FineZone(EVERYWHERE.boxes / 2.0, EVERYWHERE.discs))
    start, end = m.vertices[m.interface_vertices].transpose(1, 0, 2)
    share = np.linspace(0.0, 1.0, 25)[:, None, None]
    places = (1.0 - share) * start + share * end
    i, j = m.interface_elements.T
    half = 0.5 * ((m.centre[j] - m.centre[i]) * m.normal).sum(axis=1)[:, None] * m.normal
    rows = [label_map.labels((places + side * half).reshape(-1, 2)) for side in (-1, 0, 1)]
    count = len(m.length)
    angle = label_map.lamella_angle[np.stack([row[2] for row in rows])].reshape(3, -1, count)
    sine = np.abs(m.normal[:, 0] * np.cos(angle) + m.normal[:, 1] * np.sin(angle))
    # Diagonals of square lattices lie at 45 degrees up to rounding.
    cut_everywhere = (sine > 1.0001 * sin(pi / 4)).all(axis=(0, 1))
    parted = rows[0][2] != rows[2][2]
    has_boundary = parted.reshape(-1, count).any(axis=0)
    strong = cut_everywhere & ~has_boundary & (m.kind != Kind.NOTCH)
    assert strong.sum() > 50
    assert (m.cementite_share[strong] == 1.0).all()
    assert (m.kind[strong] == Kind.CEMENTITE).all()


@pytest.mark.parametrize("name", ["severe_AT", "severe_TA"])
@every_width
def test_facets_across_the_thin_colonies_of_a_severe_state_cut_cementite(
    name: str, width: float
) -> None:
    m = mesh(name, width)
    flow = 0 if name == "severe_AT" else 1
    across = (np.abs(m.normal[:, flow]) > 0.97) & (m.kind != Kind.NOTCH)
    assert across.sum() > 100
    weak = m.length[across] @ (1.0 - m.cementite_share[across]) / m.length[across].sum()
    assert weak < 0.05
    by_labels = kinds_by_labels(facets_of(m))[across]
    assert (by_labels != Kind.CEMENTITE).mean() > 0.04


def test_boundaries_are_as_long_as_those_of_the_map_whatever_the_width() -> None:
    label_map = substrate("undeformed").label_map
    cells = window_cells(label_map)[2].polygons
    outlines = [cells.points[row, :count] for row, count in enumerate(cells.count.tolist())]
    perimeter = sum(np.hypot(*(corners - np.roll(corners, 1, 0)).T).sum() for corners in outlines)
    exact = 0.5 * (perimeter - 4 * 90.0)
    for width in (1.0, 2.0, 4.0):
        m = mesh("undeformed", width)
        shares = shares_by_cut(facets_of(m), label_map)
        found = m.length @ shares[:, Kind.COLONY :].sum(axis=1)
        assert abs(found / exact - 0.83) < 0.05


def test_in_one_colony_both_rules_agree() -> None:
    scene = default_scene(
        window=WINDOW,
        microstructure={"prior_austenite_grain": 1e5, "block": 1e5, "colony": 1e5},
        elements={"kinds": "cut"},
    )
    m = tessellate(prepare(scene, STATES["moderate_TA"], 0), EVERYWHERE)
    by_labels = kinds_by_labels(facets_of(m))
    inner = m.kind != Kind.NOTCH
    assert np.array_equal(m.kind[inner], by_labels[inner])
    assert np.array_equal(m.cementite_share[inner], (by_labels == Kind.CEMENTITE)[inner])


def test_the_rule_changes_kinds_and_nothing_else() -> None:
    scene = default_scene(window=WINDOW, elements={"kinds": "labels"})
    old = tessellate(prepare(scene, STATES["moderate_AT"], 0), initial_zone(scene))
    cut = replace(scene, elements=replace(scene.elements, kinds="cut"))
    new = tessellate(prepare(cut, STATES["moderate_AT"], 0), initial_zone(cut))
    for field in ("vertices", "centre", "interface_elements", "interface_vertices", "junction"):
        assert np.array_equal(getattr(old, field), getattr(new, field))
    assert np.array_equal(old.cementite_share, old.kind == Kind.CEMENTITE)
    assert np.array_equal(old.kind == Kind.NOTCH, new.kind == Kind.NOTCH)
    assert (new.cementite_share[new.kind == Kind.NOTCH] == 0.0).all()
    assert (old.kind != new.kind).sum() > 50


def test_kinds_deep_in_the_fine_zone_do_not_depend_on_the_grading() -> None:
    zone = FineZone(np.empty((0, 4)), np.array([[55.0, 45.0, 25.0]]))
    found = []
    for m in (tessellate(substrate("moderate_AT"), zone), mesh("moderate_AT")):
        deep = np.hypot(*(m.midpoint - [55.0, 45.0]).T) < 15.0
        pairs = m.nucleus[m.interface_elements[deep]]
        order = np.lexsort(pairs.T)
        found.append((pairs[order], m.kind[deep][order], m.cementite_share[deep][order]))
    for one, other in zip(*found, strict=True):
        assert np.array_equal(one, other)
    assert len(found[0][0]) > 300


def test_the_boundary_between_points_turns_like_a_material_line() -> None:
    gamma = 3.0
    label_map = two_colonies(60.0, (0.0, 90.0), gamma)
    points = np.array([[50.0, 49.0], [50.0, 51.0]])
    one, other = (label_map.labels(point[None]) for point in points)
    level, normal = label_map.boundaries(one, other)
    line = np.array([1.0 / tan(radians(60.0)) + gamma, 1.0])
    assert level.tolist() == [2]
    assert abs(normal[0] @ line) < 1e-12 * np.hypot(*line)
    assert np.hypot(*normal[0]) == pytest.approx(1.0, rel=1e-14)
    nowhere, nothing = label_map.boundaries(one, one)
    assert nowhere.tolist() == [3] and not nothing.any()


def test_a_known_grain_changes_no_label() -> None:
    label_map = substrate("severe_AT").label_map
    points = np.random.default_rng(5).random((2000, 2)) * 90.0
    labels = label_map.labels(points)
    half: IntArray = np.where(points[:, 0] < 45.0, labels[0], -1)
    for one, other in zip(labels, label_map.labels(points, half), strict=True):
        assert np.array_equal(one, other)
