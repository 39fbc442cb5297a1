"""Distances measured in element widths and lengths, against all pairs one by one."""

import numpy as np
import pytest

from pearlite_petsc.microstructure.labels import make_label_map
from pearlite_petsc.tessellation import lattice
from pearlite_petsc.tessellation.lattice import Metric
from tests.scenes import STATES, default_scene


@pytest.mark.parametrize("width, length", [(2.0, 4.0), (0.5, 12.0), (6.0, 3.0)])
@pytest.mark.parametrize("state", ["undeformed", "severe_AT"])
def test_points_far_from_all_others_are_those_of_the_double_loop(
    width: float, length: float, state: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = default_scene(window={"width": 60.0, "height": 60.0, "notch": 20.0})
    scene = default_scene(elements={"width": width, "length": length}, window=scene.window)
    labels = make_label_map(scene.microstructure, scene.window, STATES[state], 0)
    metric = Metric(labels, scene.elements)
    rng = np.random.default_rng(8)
    others = 60.0 * rng.random((round(3600.0 / (width * length)), 2))
    points = 60.0 * rng.random((700, 2))
    frames = metric.frames(points)
    gap = points[:, None] - others
    xx, xy, yy = frames.T[:, :, None]
    squared = xx * gap[..., 0] ** 2 + 2.0 * xy * gap[..., 0] * gap[..., 1] + yy * gap[..., 1] ** 2
    wanted = np.sqrt(squared.min(axis=1)) >= 0.85
    assert 5 < wanted.sum() < 690
    for at_once in (lattice.AT_ONCE, 7):
        monkeypatch.setattr(lattice, "AT_ONCE", at_once)
        np.testing.assert_array_equal(metric.far_from(points, others, 0.85), wanted)
