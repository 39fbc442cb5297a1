import numpy as np
import pytest
import shapely

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import MeshError
from pearlite_petsc.tessellation.voronoi import bounded_voronoi, cell_areas, merged_groups


def random_points(count: int, seed: int) -> FloatArray:
    return np.random.default_rng(seed).random((count, 2)) * [30.0, 20.0]


def test_cells_are_those_that_shapely_clips_to_the_rectangle() -> None:
    points = random_points(200, 1)
    diagram = bounded_voronoi(points, 30.0, 20.0, np.full(200, 4.0))
    area = cell_areas(diagram.vertices, diagram.offsets, diagram.vertex_indices)
    cells = shapely.voronoi_polygons(
        shapely.MultiPoint(points), extend_to=shapely.box(-9, -9, 40, 30)
    )
    exact = np.empty(200)
    for cell in cells.geoms:
        inside = shapely.contains_xy(cell, points[:, 0], points[:, 1])
        exact[np.flatnonzero(inside)[0]] = cell.intersection(shapely.box(0, 0, 30, 20)).area
    assert np.abs(area - exact).max() < 1e-9


def test_too_short_a_reach_is_widened_until_the_cells_close() -> None:
    points = random_points(50, 2)
    short = bounded_voronoi(points, 30.0, 20.0, np.full(50, 1e-3))
    long = bounded_voronoi(points, 30.0, 20.0, np.full(50, 1e3))
    assert np.array_equal(short.pairs, long.pairs)
    areas = [cell_areas(d.vertices, d.offsets, d.vertex_indices) for d in (short, long)]
    assert np.abs(areas[0] - areas[1]).max() < 1e-9


def test_a_square_lattice_has_four_neighbours_and_shared_corners() -> None:
    x, y = np.meshgrid(np.arange(10) + 0.5, np.arange(10) + 0.5)
    diagram = bounded_voronoi(
        np.column_stack([x.ravel(), y.ravel()]), 10.0, 10.0, np.full(100, 2.0)
    )
    assert len(diagram.pairs) == 180
    assert len(diagram.vertices) == 121
    assert (np.diff(diagram.offsets) == 4).all()
    assert len(diagram.boundary) == 40


def test_every_point_is_nearest_to_the_nucleus_of_its_cell() -> None:
    points = random_points(60, 3)
    diagram = bounded_voronoi(points, 30.0, 20.0, np.full(60, 8.0))
    for cell in range(60):
        corners = diagram.vertices[
            diagram.vertex_indices[diagram.offsets[cell] : diagram.offsets[cell + 1]]
        ]
        gap = np.hypot(*(corners[:, None] - points[None]).transpose(2, 0, 1))
        assert np.abs(gap[:, cell] - gap.min(axis=1)).max() < 1e-9


def test_the_boundary_runs_counter_clockwise_once_round() -> None:
    diagram = bounded_voronoi(random_points(80, 4), 30.0, 20.0, np.full(80, 6.0))
    ends = diagram.vertices[diagram.boundary_facets]
    assert ends[0, 0].tolist() == [0.0, 0.0]
    assert np.array_equal(ends[1:, 0], ends[:-1, 1])
    assert ends[-1, 1].tolist() == [0.0, 0.0]
    x, y = ends[:, 0, 0], ends[:, 0, 1]
    assert abs(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) - 600.0) < 1e-9


def test_two_nuclei_are_no_mesh() -> None:
    with pytest.raises(MeshError, match="holds 2 nuclei"):
        bounded_voronoi(random_points(2, 5), 30.0, 20.0, np.full(2, 4.0))


def test_a_nucleus_that_stands_twice_is_refused() -> None:
    points = random_points(40, 6)
    points[7] = points[3]
    with pytest.raises(MeshError):
        bounded_voronoi(points, 30.0, 20.0, np.full(40, 9.0))


def test_joined_things_form_one_group_named_after_the_first() -> None:
    joined = np.array([[4, 2], [2, 7], [5, 6]])
    assert merged_groups(8, joined).tolist() == [0, 1, 2, 3, 2, 5, 5, 2]
