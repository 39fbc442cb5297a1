import dataclasses
import math
import struct
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import matplotlib as mpl
import numpy as np
from numpy.testing import assert_allclose

from pearlite_petsc.fatigue.outcome import StopReason
from pearlite_petsc.output.experiment import MeasuredPoint
from pearlite_petsc.output.figures import (
    charts,
    cracks,
    growth,
    microstructure,
    null_model,
    rates,
)
from pearlite_petsc.output.figures.style import drawing, state_label, state_styles
from pearlite_petsc.output.snapshot import snapshot
from tests.output import synthetic
from tests.scenes import STATES


def size(path: Path) -> tuple[int, int]:
    """Return width and height of a PNG whose drawing has more than one colour."""
    data = path.with_suffix(".png").read_bytes()
    assert data.startswith(b"\x89PNG")
    assert len(data) > 5_000
    assert ElementTree.parse(path.with_suffix(".svg")).getroot().tag.endswith("svg")
    width, height = struct.unpack(">II", data[16:24])
    return width, height


def texts(path: Path) -> str:
    """Return the words of a figure: SVG keeps each text as a comment before its outlines."""
    return path.with_suffix(".svg").read_text(encoding="utf-8")


def test_the_rate_figure_names_states_literature_and_measured_points(tmp_path: Path) -> None:
    points = [MeasuredPoint("undeformed", 15.0, 1e-8), MeasuredPoint("my_steel", 12.0, 2e-8)]
    rates.draw_rates(tmp_path / "fcg", synthetic.outcomes(), list(STATES.values()), points)
    assert size(tmp_path / "fcg")[0] == 7.4 * 200
    words = texts(tmp_path / "fcg")
    for text in ("severe T-A", "Barsom", "BS 7910", "EN 13674-1", "my_steel", "m/cycle"):
        assert text in words, text


def test_rate_figures_can_do_without_cracks_or_with_one_state(tmp_path: Path) -> None:
    rates.draw_rates(tmp_path / "none", [], list(STATES.values()))
    one = [o for o in synthetic.outcomes(meshes=1) if o.state == "undeformed"]
    rates.draw_rates(tmp_path / "one", one, [STATES["undeformed"]])
    null_model.draw_null_model(tmp_path / "null", synthetic.outcomes(), list(STATES.values()))
    for name in ("none", "one", "null"):
        size(tmp_path / name)


def test_rate_figures_say_which_cracks_arrested_or_are_a_part_of_the_meshes(tmp_path: Path) -> None:
    tasks = synthetic.outcomes()
    rates.draw_rates(tmp_path / "all", tasks, list(STATES.values()))
    null_model.draw_null_model(tmp_path / "all_null", tasks, list(STATES.values()))
    changes = {
        ("undeformed", 8e3): {"stop_reason": StopReason.ARRESTED, "da_dn": math.nan},
        ("severe_TA", 12e3): {"stop_reason": StopReason.BOUNDARY},
    }
    mixed = [
        dataclasses.replace(o, **changes.get((o.state, o.delta_k), {})) if o.mesh_index else o
        for o in tasks
    ]
    rates.draw_rates(tmp_path / "mixed", mixed, list(STATES.values()))
    null_model.draw_null_model(tmp_path / "mixed_null", mixed, list(STATES.values()))
    for label in (rates.ARRESTED_LABEL, rates.PART_LABEL, rates.EARLY_LABEL):
        assert label in texts(tmp_path / "mixed")
        assert label not in texts(tmp_path / "all")
    assert null_model.BOUND_LABEL in texts(tmp_path / "mixed_null")
    assert null_model.BOUND_LABEL not in texts(tmp_path / "all_null")
    # Not one rate: the literature is still in the picture.
    stuck = [dataclasses.replace(o, **changes[("undeformed", 8e3)]) for o in tasks]
    rates.draw_rates(tmp_path / "stuck", stuck, list(STATES.values()))
    null_model.draw_null_model(tmp_path / "stuck_null", stuck, list(STATES.values()))
    assert size(tmp_path / "stuck") == size(tmp_path / "all")
    # What stands at the axis takes no room from the panels.
    assert size(tmp_path / "mixed") == size(tmp_path / "all")


def test_severe_shear_is_shown_by_its_grains_where_colonies_are_thinner_than_a_pixel(
    tmp_path: Path,
) -> None:
    coarse = quartered()
    assert microstructure.is_legible(coarse.colony)
    thin = dataclasses.replace(coarse, colony=np.arange(coarse.colony.size).reshape(80, 80))
    assert not microstructure.is_legible(thin.colony)
    for name, raster in (("coarse", coarse), ("thin", thin)):
        cracks.draw_state_path(tmp_path / name, "severe_AT", raster, [], (30.0, 40.0), 0)
    assert "hatching: lamellae" in texts(tmp_path / "coarse")
    assert "tints: prior austenite grains" in texts(tmp_path / "thin")


def test_growth_tortuosity_and_paths_are_drawn(tmp_path: Path) -> None:
    tasks = synthetic.outcomes()
    growth.draw_growth(tmp_path / "growth", tasks, list(STATES))
    growth.draw_tortuosity(tmp_path / "tortuosity", tasks, list(STATES))
    lines = {o.state: [cracks.PathLine("a", o.shape.path)] for o in tasks if o.shape is not None}
    cracks.draw_paths(tmp_path / "paths", lines, (200.0, 200.0), "paths")
    for name in ("growth", "tortuosity", "paths"):
        size(tmp_path / name)


def test_a_states_path_is_drawn_with_and_without_the_damage(tmp_path: Path) -> None:
    last = snapshot(synthetic.growth_states(synthetic.voronoi_mesh(), 5)[-1])
    raster = quartered()
    path = np.array([[30.0, 40.0], [60.0, 44.0]])
    lines = [cracks.PathLine("12", path), cracks.PathLine("20", path + 1.0)]
    for name, step in (("with", last), ("without", None)):
        target = tmp_path / name
        cracks.draw_state_path(target, "severe_AT", raster, lines, (30.0, 40.0), 0, step)
        size(target)


def quartered() -> microstructure.LabelRaster:
    """Return four colonies that meet in the middle of an 80 um window."""

    def labels(points):
        colony = (points[:, 0] > 40.0).astype(int) + 2 * (points[:, 1] > 40.0)
        return colony * 0, colony // 2, colony

    angles = np.array([0.0, 0.5, 1.0, 1.5])
    return microstructure.label_raster(labels, angles, (0.0, 80.0, 0.0, 80.0), columns=80)


def test_a_raster_has_the_labels_of_its_pixels_with_y_upwards() -> None:
    raster = quartered()
    assert raster.colony.shape == (80, 80)
    assert (raster.colony[0, 0], raster.colony[0, -1], raster.colony[-1, 0]) == (0, 1, 2)
    assert raster.lamella_angle[-1, -1] == 1.5
    picture = microstructure.hatched(raster, raster.colony)
    assert picture.min() > 0.5
    assert picture.max() <= 1.0
    # Lamellae along x: the stripes change along y only.
    assert_allclose(np.ptp(picture[:40, :40], axis=1), 0.0, atol=1e-12)
    assert np.ptp(picture[:40, 0], axis=0).max() > 0.05


def test_microstructure_mesh_and_angles_are_drawn(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    microstructure.draw_microstructure(tmp_path / "levels", {"undeformed": quartered()})
    mesh = synthetic.voronoi_mesh()
    segments = mesh.vertices[mesh.interface_vertices]
    microstructure.draw_mesh(tmp_path / "mesh", {"undeformed": (segments, mesh.kind)})
    angles = {"undeformed": rng.uniform(0.0, np.pi, 500)}
    closed = {"undeformed": lambda angle: angle / np.pi}
    microstructure.draw_lamella_angles(tmp_path / "angles", angles, closed)
    microstructure.draw_lamella_roses(tmp_path / "roses", angles)
    for name in ("levels", "mesh", "angles", "roses"):
        size(tmp_path / name)
    assert "prior austenite grain" in texts(tmp_path / "mesh")


def test_the_pareto_front_holds_what_nothing_beats() -> None:
    cost = np.array([1.0, 2.0, 2.0, 3.0, 4.0, 5.0])
    error = np.array([0.5, 0.6, 0.2, 0.2, 0.1, 0.3])
    assert charts.pareto_front(cost, error).tolist() == [0, 2, 4]
    rng = np.random.default_rng(2)
    cost, error = rng.uniform(size=(2, 60))
    beaten = [
        np.any((cost <= cost[i]) & (error <= error[i]) & ((cost < cost[i]) | (error < error[i])))
        for i in range(60)
    ]
    assert sorted(charts.pareto_front(cost, error)) == np.flatnonzero(~np.array(beaten)).tolist()


def test_charts_of_the_method_are_drawn(tmp_path: Path) -> None:
    settings = [
        charts.Setting("euler 0.1", "euler", 10.0, 0.10, error_low=0.08, error_high=0.12),
        charts.Setting("compliance 1", "compliance", 2.0, 0.03, is_default=True),
        charts.Setting("reference", "reference", 60.0, 0.0),
    ]
    charts.draw_pareto(tmp_path / "pareto", settings)
    studies = {
        "Poisson ratio": [
            ("0.3", "converges", "14 it"),
            ("0.34", "stops with a reason", "k_t < 0"),
        ],
        "damage step": [
            ("1", "converges", ""),
            ("2", "falls back", "direct"),
            ("9", "wrong or crashes", ""),
        ],
    }
    charts.draw_stability(tmp_path / "stability", studies)
    certificates = {
        "severe_AT raje affine": {"E_y/E": 400.0, "nu": 0.7},
        "homogeneous": {"E_y/E": 1.0, "nu": 0.0},
    }
    charts.draw_elastic(tmp_path / "elastic", certificates, {"E_y/E": 1.0, "nu": 0.3})
    for name in ("pareto", "stability", "elastic"):
        size(tmp_path / name)
    assert "default: compliance 1" in texts(tmp_path / "pareto")


def test_states_have_distinct_colours_and_the_sources_five_always_the_same() -> None:
    five = state_styles(list(STATES))
    assert len({style.colour for style in five.values()}) == 5
    assert state_styles(["severe_AT"])["severe_AT"] == five["severe_AT"]
    mixed = state_styles(["mine", "severe_AT", "yours"])
    assert len({style.colour for style in mixed.values()}) == 3
    assert state_label("moderate_TA") == "moderate T-A"


def test_a_figure_leaves_matplotlibs_settings_as_they_were(tmp_path: Path) -> None:
    before = dict(mpl.rcParams)
    with drawing(tmp_path / "a") as figure:
        figure.subplots().plot([0, 1])
    assert dict(mpl.rcParams) == before


def test_the_same_data_give_the_same_files(tmp_path: Path) -> None:
    for name in ("a", "b"):
        growth.draw_tortuosity(tmp_path / name, synthetic.outcomes(), list(STATES))
    for suffix in (".png", ".svg"):
        first = (tmp_path / "a").with_suffix(suffix).read_bytes()
        assert first == (tmp_path / "b").with_suffix(suffix).read_bytes()
