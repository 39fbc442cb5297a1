"""What the map of stability shows to be wrong is said before the run, and nothing else is."""

import csv
from pathlib import Path

import pytest

from pearlite_petsc.config import load_scene_text, method_warnings
from pearlite_petsc.errors import SceneError

SETTINGS = {
    "nu, raje": ("material.springs=raje", "material.poisson_ratio={}"),
    "nu, matched": ("material.springs=matched", "material.poisson_ratio={}"),
    "gamma, affine": ("elements.shear=affine", "states.severe_AT.shear_strain={}"),
    "gamma, remesh": ("elements.shear=remesh", "states.severe_AT.shear_strain={}"),
    "delta_d, compliance": ("cycle_jump.method=compliance", "cycle_jump.delta_d={}"),
    "delta_d, euler": ("cycle_jump.method=euler", "cycle_jump.delta_d={}"),
    "solver tolerance": ("solver.relative_tolerance={}",),
}
STEELS = ("undeformed", "moderate_AT", "moderate_TA", "severe_TA")


def points() -> list[tuple[str, str, str]]:
    table = Path(__file__).parents[2] / "docs" / "benchmarks" / "stability.csv"
    with table.open(newline="", encoding="utf-8") as file:
        rows = [(row["study"], row["value"], row["outcome"]) for row in csv.DictReader(file)]
    return [row for row in rows if row[0] in SETTINGS]


@pytest.mark.parametrize(("study", "value", "outcome"), points())
def test_what_was_measured_to_be_wrong_is_noticed(study: str, value: str, outcome: str) -> None:
    settings = [text.format(value) for text in SETTINGS[study]]
    # The other states' own shear must not speak for the one that is varied.
    settings += [f"states.{name}.shear_strain=0.0" for name in STEELS]
    if outcome.startswith("stops"):
        with pytest.raises(SceneError):
            load_scene_text("", "test", settings)
        return
    warnings = method_warnings(load_scene_text("", "test", settings))
    assert len(warnings) == outcome.startswith("wrong"), warnings


def windows() -> list[tuple[float, str]]:
    table = Path(__file__).parents[2] / "docs" / "benchmarks" / "stability.csv"
    with table.open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["study"] == "window over extension"]
    return [(float(row["value"]), row["outcome"]) for row in rows if "stops" not in row["outcome"]]


@pytest.mark.parametrize(("value", "outcome"), windows())
def test_a_window_that_was_measured_to_be_too_small_is_noticed(value: float, outcome: str) -> None:
    sides = [f"window.{key}_um={30.0 * value}" for key in ("width", "height")]
    rest = ["window.notch_um=10", "loading.extension_um=1"]
    warnings = method_warnings(load_scene_text("", "test", [*sides, *rest]))
    assert len(warnings) == outcome.startswith("wrong"), warnings


def jumps() -> list[tuple[str, str, str]]:
    table = Path(__file__).parents[2] / "docs" / "benchmarks" / "jumps.csv"
    with table.open(newline="", encoding="utf-8") as file:
        return [(row["method"], row["step"], row["error"]) for row in csv.DictReader(file)]


@pytest.mark.parametrize(("method", "step", "error"), jumps())
def test_every_jump_that_was_measured_to_be_wrong_is_noticed(
    method: str, step: str, error: str
) -> None:
    key = "tolerance" if method == "adaptive" else "delta_d"
    settings = [f"cycle_jump.method={method}", f"cycle_jump.{key}={step}"]
    warnings = method_warnings(load_scene_text("", "test", settings))
    # No error at all (nan) means that no crack took the reference's path.
    assert len(warnings) == (not float(error) <= 0.1), warnings


def test_the_default_scene_is_within_all_limits() -> None:
    assert method_warnings(load_scene_text("", "test", [])) == []


def test_a_load_above_the_fracture_toughness_is_named_with_its_key() -> None:
    levels = "loading.delta_k_mpa_sqrt_m=[18, 36, 36.1, 5000]"
    (warning,) = method_warnings(load_scene_text("", "test", [levels]))
    assert warning.startswith("Delta-K = 36.1, 5000 MPa sqrt(m): K_max = 5555.56 is above")
    assert "material.fracture_toughness_mpa_sqrt_m" in warning
    tougher = "material.fracture_toughness_mpa_sqrt_m=6000"
    assert method_warnings(load_scene_text("", "test", [levels, tougher])) == []
    # The largest load counts, not the range.
    (warning,) = method_warnings(load_scene_text("", "test", ["loading.load_ratio=0.5"]))
    assert warning.startswith("Delta-K = 25 MPa sqrt(m): K_max = 50 ")


@pytest.mark.parametrize(("notch", "count"), [(0.1, 1), (7.9, 1), (8.0, 0), (80.0, 0)])
def test_a_notch_that_ends_at_the_windows_edge_is_named(notch: float, count: int) -> None:
    warnings = method_warnings(load_scene_text("", "test", [f"window.notch_um={notch}"]))
    assert len(warnings) == count
    assert all("notch of" in warning for warning in warnings)
