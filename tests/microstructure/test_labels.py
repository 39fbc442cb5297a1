from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import kstest

from pearlite_petsc.errors import MeshError
from pearlite_petsc.microstructure.cells import (
    equivalent_diameters,
    undeformed_cells,
    whole_cells,
    window_cells,
)
from pearlite_petsc.microstructure.labels import LabelMap, make_label_map
from pearlite_petsc.microstructure.shear import sheared_angle_cdf
from pearlite_petsc.scene import State
from tests.scenes import STATES, default_scene

SCENE = default_scene()
every_state = pytest.mark.parametrize("state", STATES.values(), ids=lambda state: state.name)


def made(state: State, index: int) -> LabelMap:
    return make_label_map(SCENE.microstructure, SCENE.window, state, index)


@every_state
def test_mean_sizes_over_four_meshes_are_within_five_percent(state: State) -> None:
    diameters = [equivalent_diameters(made(state, index)) for index in range(4)]
    for level, target in enumerate((60.0, 30.0, 15.0)):
        mean = np.concatenate([mesh[level] for mesh in diameters]).mean()
        assert abs(mean / target - 1.0) < 0.05


def test_the_mean_sizes_have_no_bias_beyond_two_percent_at_other_ratios() -> None:
    sizes = replace(SCENE.microstructure, prior_austenite_grain=40.0, block=32.0, colony=10.0)
    window = replace(SCENE.window, width=600.0, height=600.0)
    diameters = [
        equivalent_diameters(make_label_map(sizes, window, STATES["undeformed"], index))
        for index in range(2)
    ]
    for level, target in enumerate((40.0, 32.0, 10.0)):
        mean = np.concatenate([mesh[level] for mesh in diameters]).mean()
        assert abs(mean / target - 1.0) < 0.02


@every_state
def test_areas_nest_exactly(state: State) -> None:
    label_map = made(state, 0)
    areas = [cells.area() for cells in undeformed_cells(label_map)]
    for level in (1, 2):
        children = np.bincount(label_map.levels[level].parent, weights=areas[level])
        assert np.abs(children / areas[level - 1] - 1.0).max() < 1e-9


@every_state
def test_the_cells_of_every_level_fill_the_window(state: State) -> None:
    for cells in window_cells(made(state, 1)):
        assert abs(cells.polygons.area().sum() - 40_000.0) < 1e-9 * 40_000.0


@every_state
def test_a_point_has_the_labels_of_the_polygons_around_it(state: State) -> None:
    label_map = made(state, 0)
    for level, cells in enumerate(window_cells(label_map)):
        # The corners' mean lies inside a convex cell.
        middle = np.array([polygon.mean(axis=0) for polygon in cells.polygons.listed()])
        roomy = cells.polygons.area() > 1e-3
        assert np.array_equal(label_map.labels(middle)[level][roomy], cells.label[roomy])


def test_labels_nest_and_agree_with_a_search_one_point_at_a_time() -> None:
    label_map = made(STATES["severe_TA"], 2)
    points = np.random.default_rng(1).random((300, 2)) * 200
    labels = label_map.labels(points)
    undeformed = points @ np.linalg.inv(label_map.deformation).T
    for i in range(300):
        parent = 0
        for level, label in zip(label_map.levels, labels, strict=True):
            members = np.flatnonzero(level.parent == parent)
            gap = np.hypot(*(level.seeds[members] - undeformed[i]).T)
            assert label[i] == members[gap.argmin()]
            parent = label[i]


@every_state
def test_lamella_angles_follow_the_closed_form_distribution(state: State) -> None:
    maps = [made(state, index) for index in range(4)]
    angles = np.concatenate([m.lamella_angle[whole_cells(m)[2]] for m in maps])
    assert len(angles) > 700
    result = kstest(
        angles, lambda angle: sheared_angle_cdf(angle, state.shear_strain, state.orientation)
    )
    assert result.pvalue > 0.01
    if state.shear_strain:
        wrong = kstest(angles, lambda angle: angle / np.pi)
        assert wrong.pvalue < 1e-6


def test_meshes_and_seeds_differ_and_one_mesh_is_always_the_same() -> None:
    state = STATES["undeformed"]
    first, again, second = made(state, 0), made(state, 0), made(state, 1)
    other = make_label_map(replace(SCENE.microstructure, seed=2), SCENE.window, state, 0)
    assert np.array_equal(first.levels[2].seeds, again.levels[2].seeds)
    assert np.array_equal(first.lamella_angle, again.lamella_angle)
    for different in (second, other):
        assert not np.array_equal(first.lamella_angle[:50], different.lamella_angle[:50])


def test_sizes_that_do_not_descend_are_refused() -> None:
    sizes = replace(SCENE.microstructure, block=70.0)
    with pytest.raises(MeshError, match="must descend"):
        make_label_map(sizes, SCENE.window, STATES["undeformed"], 0)
