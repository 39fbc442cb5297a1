from functools import cache

import numpy as np
import pytest

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.errors import MeshError
from pearlite_petsc.scene import Kind, Window
from pearlite_petsc.tessellation.affine import AffineCells, diagram_of
from pearlite_petsc.tessellation.assemble import DROPPING
from pearlite_petsc.tessellation.build import build_mesh, prepare, tessellate
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.notch_split import split_at_notch
from pearlite_petsc.tessellation.zone import FineZone
from tests.scenes import STATES, default_scene
from tests.tessellation.closure import outward_sums

SCENE = default_scene(
    window={"width": 120.0, "height": 100.0, "notch": 40.0}, elements={"shear": "affine"}
)
every_state = pytest.mark.parametrize("name", STATES)


@cache
def mesh(name: str) -> Mesh:
    return build_mesh(SCENE, STATES[name], 0)


@every_state
def test_elements_fill_the_window_and_their_outward_normals_cancel(name: str) -> None:
    m = mesh(name)
    assert abs(m.area.sum() - 12_000.0) < 1e-6
    assert (m.area > 0).all()
    outward = outward_sums(m)
    assert np.abs(outward).max() < 6 * DROPPING * np.sqrt(8.0)
    assert np.median(np.abs(outward)) < 1e-10


@every_state
def test_centres_lie_on_their_own_sides_of_every_interface(name: str) -> None:
    m = mesh(name)
    i, j = m.interface_elements.T
    assert (((m.midpoint - m.centre[i]) * m.normal).sum(axis=1) > 0).all()
    assert (((m.centre[j] - m.midpoint) * m.normal).sum(axis=1) > 0).all()
    step = m.vertices[m.interface_vertices[:, 1]] - m.vertices[m.interface_vertices[:, 0]]
    assert np.abs((step * m.normal).sum(axis=1)).max() < 1e-9


@every_state
def test_the_notch_is_one_straight_run_and_everything_hangs_together(name: str) -> None:
    m = mesh(name)
    notch = m.kind == Kind.NOTCH
    ends = m.vertices[m.interface_vertices[notch]]
    assert (ends[:, :, 1] == 50.0).all()
    assert abs(m.length[notch].sum() - m.notch[0]) < 0.05
    assert abs(m.notch[0] - 40.0) < 4.0
    held = np.bincount(m.interface_elements[~notch].ravel(), minlength=m.element_count)
    assert held.min() >= 1


def test_shear_stretches_the_elements_along_the_sheared_lamellae() -> None:
    flat, sheared = mesh("undeformed"), mesh("severe_AT")
    assert np.median(sheared.length) > 8 * np.median(flat.length)
    steep = np.abs(sheared.normal[:, 1]) > 0.99
    assert sheared.length[steep].sum() > 0.9 * sheared.length.sum()


def test_without_shear_the_elements_are_voronoi_cells_along_the_lamellae() -> None:
    m = mesh("undeformed")
    away = (np.abs(m.midpoint - [60.0, 50.0]) < [55.0, 45.0]).all(axis=1)
    away &= np.abs(m.midpoint[:, 1] - 50.0) > 5.0
    assert abs(np.median(m.length[away & (m.kind == Kind.LAMELLA)]) - 4.0) < 0.1
    assert abs(np.median(m.length[away & (m.kind == Kind.CEMENTITE)]) - 2.0) < 0.05


def test_there_is_one_affine_mesh_whatever_the_zone() -> None:
    substrate = prepare(SCENE, STATES["moderate_AT"], 0)
    zone = FineZone(np.empty((0, 4)), np.array([[1.0, 2.0, 3.0]]))
    assert tessellate(substrate, zone) is tessellate(substrate, zone, np.array([3]))
    assert substrate.affine is not None
    assert substrate.affine.fine.all()
    assert len(np.unique(substrate.affine.nucleus)) == substrate.affine.element_count


def unit_squares() -> tuple[FloatArray, list[IntArray]]:
    """Four unit squares in a row; the notch line passes through their middle."""
    x = np.arange(5.0)
    vertices = np.concatenate([np.column_stack([x, np.zeros(5)]), np.column_stack([x, np.ones(5)])])
    return vertices, [np.array([i, i + 1, i + 6, i + 5]) for i in range(4)]


def test_elements_before_the_tip_are_cut_and_the_next_one_shares_the_cut_corner() -> None:
    vertices, squares = unit_squares()
    window = Window(4.0, 1.0, 2.2)
    points, polygons, parent, lower = split_at_notch(vertices, squares, window)
    assert parent.tolist() == [0, 0, 1, 1, 2, 3]
    assert lower.tolist() == [False, True, False, True, False, False]
    assert [len(polygon) for polygon in polygons] == [4, 4, 4, 4, 5, 4]
    assert sorted(points[10:].tolist()) == [[0.0, 0.5], [1.0, 0.5], [2.0, 0.5]]
    offsets = np.concatenate([[0], np.cumsum([len(p) for p in polygons])])
    cells = AffineCells(points, offsets, np.concatenate(polygons), np.zeros((6, 2)), parent)
    assert len(diagram_of(cells, window).pairs) == 7


def test_neighbours_that_do_not_share_their_edges_are_refused() -> None:
    vertices, squares = unit_squares()
    offsets = np.array([0, 4, 8, 12])
    cells = AffineCells(
        vertices,
        offsets,
        np.concatenate([squares[0], *squares[2:]]),
        np.zeros((3, 2)),
        np.arange(3),
    )
    with pytest.raises(MeshError, match="do not share"):
        diagram_of(cells, Window(4.0, 1.0, 1.0))
