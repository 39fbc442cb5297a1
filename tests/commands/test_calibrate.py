"""The calibrated C brings computed rates to measured ones, with an honest error."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pearlite_petsc.calibrate import main
from pearlite_petsc.config import load_scene_text, scene_to_toml
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.calibration import calibrate
from pearlite_petsc.output.experiment import MeasuredPoint
from pearlite_petsc.output.tables import write_fcg

DELTA_K = (8e3, 12e3, 18e3, 25e3)


def outcome(state: str, mesh: int, delta_k: float, da_dn: float) -> Outcome:
    return Outcome(state, mesh, delta_k, StopReason.GROWN, da_dn=da_dn)


def power_law(
    state: str = "severe_AT", factors: tuple[float, ...] = (0.5, 1.0, 2.0), scale: float = 1e-13
) -> list[Outcome]:
    """Return rates factor x scale x delta_k^3, whose geometric mean over meshes is known."""
    return [
        outcome(state, mesh, delta_k, factor * scale * delta_k**3)
        for mesh, factor in enumerate(factors)
        for delta_k in DELTA_K
    ]


def on_the_law(delta_k: float, ratio: float, state: str = "severe_AT") -> MeasuredPoint:
    return MeasuredPoint(state, delta_k, ratio * 1e-10 * delta_k**3)


def test_points_off_by_one_factor_give_that_factor_between_and_on_computed_delta_k() -> None:
    points = [on_the_law(delta_k, 2.5) for delta_k in (8.0, 9.0, 15.0, 18.0, 25.0)]
    result = calibrate(power_law(), points)
    assert result.factor == pytest.approx(2.5, rel=1e-12)
    assert [ratio for _, ratio in result.ratios] == pytest.approx([2.5] * 5, rel=1e-12)
    assert result.error_points < 1e-12
    assert result.error_meshes == pytest.approx(math.log(2.0) / math.sqrt(3), rel=1e-12)


def test_the_factor_is_the_geometric_mean_of_the_ratios() -> None:
    points = [on_the_law(9, 1.0), on_the_law(15, 4.0)]
    result = calibrate(power_law(factors=(1.0, 1.0)), points)
    assert result.factor == pytest.approx(2.0, rel=1e-12)
    assert result.error == pytest.approx(math.log(2.0), rel=1e-12)
    # Student's t of one degree of freedom.
    assert result.interval[1] == pytest.approx(2.0 ** (1 + 12.7062047), rel=1e-6)
    assert result.interval[0] * result.interval[1] == pytest.approx(4.0, rel=1e-9)


def test_rates_scaled_by_the_factor_need_no_further_calibration() -> None:
    points = [on_the_law(9, 1.3), on_the_law(11, 4.0), on_the_law(20, 0.7)]
    first = calibrate(power_law(), points)
    again = calibrate(power_law(scale=1e-13 * first.factor), points)
    assert again.factor == pytest.approx(1.0, rel=1e-12)
    assert again.error == pytest.approx(first.error, rel=1e-9)


def test_a_point_outside_the_computed_delta_k_is_left_out_and_named() -> None:
    points = [on_the_law(7.9, 99.0), on_the_law(10, 3.0), on_the_law(26, 99.0)]
    result = calibrate(power_law(), [*points, MeasuredPoint("severe_TA", 10.0, 1.0)])
    assert result.factor == pytest.approx(3.0, rel=1e-12)
    assert result.left_out == (
        "severe_AT at 7.9 MPa sqrt(m): below the smallest computed, 8",
        "severe_AT at 26 MPa sqrt(m): above the largest computed, 25",
        "severe_TA at 10 MPa sqrt(m): the state has no computed growth rate",
    )


def test_a_mesh_that_failed_once_is_left_out_of_the_mean() -> None:
    outcomes = power_law(factors=(0.5, 1.0, 8.0))
    outcomes[9] = replace(outcomes[9], da_dn=math.nan, stop_reason=StopReason.FAILED)
    result = calibrate(outcomes, [on_the_law(9, 1.0), on_the_law(13, 1.0)])
    assert result.ungrown == ("severe_AT mesh 2: no rate at 12 MPa sqrt(m)",)
    assert result.factor == pytest.approx(math.sqrt(2.0), rel=1e-12)


def test_a_delta_k_at_which_one_mesh_arrested_is_not_on_the_curve() -> None:
    outcomes = power_law()
    outcomes[0] = replace(outcomes[0], da_dn=math.nan, stop_reason=StopReason.ARRESTED)
    result = calibrate(outcomes, [on_the_law(9, 1.0), on_the_law(13, 2.0)])
    assert result.ungrown == ("severe_AT at 8 MPa sqrt(m): 1 of 3 meshes arrested",)
    assert result.left_out == ("severe_AT at 9 MPa sqrt(m): below the smallest computed, 12",)
    assert result.factor == pytest.approx(2.0, rel=1e-12)


def test_one_point_or_one_mesh_has_an_unknown_error() -> None:
    one_point = calibrate(power_law(), [on_the_law(9, 1.0)])
    assert math.isnan(one_point.error_points)
    assert math.isnan(one_point.interval[0])
    one_mesh = calibrate(power_law(factors=(1.0,)), [on_the_law(9, 1.0), on_the_law(10, 2.0)])
    assert math.isnan(one_mesh.error_meshes)
    assert one_mesh.error_points > 0.3


def test_the_confidence_interval_holds_the_true_factor_as_often_as_it_says() -> None:
    random = np.random.default_rng(5)
    held = 0
    for _ in range(400):
        outcomes = []
        for state in ("severe_AT", "undeformed"):
            outcomes += power_law(state, tuple(np.exp(random.normal(0.0, 0.4, 5))))
        points = [
            on_the_law(delta_k, 3.0 * math.exp(random.normal(0.0, 0.3)), state)
            for state in ("severe_AT", "undeformed")
            for delta_k in random.uniform(8.0, 25.0, 4)
        ]
        low, high = calibrate(outcomes, points).interval
        held += low < 3.0 < high
    # Binomial, 400 draws at 0.95: 3.5 standard deviations either side.
    assert 0.91 < held / 400 < 0.99


def test_no_point_on_a_curve_is_an_error_with_the_reason() -> None:
    with pytest.raises(SceneError, match="no measured point lies on a computed curve: severe_AT"):
        calibrate(power_law(), [on_the_law(30, 1.0)])
    with pytest.raises(SceneError, match="there are none"):
        calibrate(power_law(), [])


@pytest.fixture
def result_folder(tmp_path: Path) -> Path:
    folder = tmp_path / "result"
    folder.mkdir()
    scene = load_scene_text("[states.severe_AT]\n[states.severe_TA]\n", "a.toml")
    (folder / "scene.resolved.toml").write_text(scene_to_toml(scene))
    outcomes = power_law() + power_law("severe_TA", scale=1e-14)
    write_fcg(folder / "fcg.csv", outcomes, ["severe_AT", "severe_TA"])
    return folder


def written_points(folder: Path, *rows: str) -> Path:
    file = folder / "rail.csv"
    file.write_text("\n".join(["da_dn_m_per_cycle,note,state,delta_k_mpa_sqrt_m", *rows]) + "\n")
    return file


def test_the_command_prints_the_line_for_the_scene(
    result_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # 2 x 1e-13 um/cycle/(MPa sqrt(um))^3 x (10e3)^3 = 0.2 um/cycle.
    points = written_points(result_folder, "2e-7,a,severe_AT,10", "6.75e-7,b,severe_AT,15")
    assert main([str(result_folder), "--experiment", str(points)]) == 0
    printed = capsys.readouterr().out
    line = next(line for line in printed.splitlines() if line.startswith("c_um5_per_n2"))
    scene = load_scene_text("[damage]\n" + line, "a.toml")
    assert scene.damage.c == pytest.approx(8.82e-9, rel=1e-5)
    assert "factor on C: 2\n" in printed
    assert "points used: 2 of 2" in printed


def test_the_command_takes_the_points_of_one_state_only(
    result_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    points = written_points(result_folder, "2e-7,a,severe_AT,10", "3e-8,b,severe_TA,10")
    arguments = [str(result_folder), "--experiment", str(points)]
    assert main([*arguments, "--state", "severe_TA"]) == 0
    assert "factor on C: 3\n" in capsys.readouterr().out
    assert main([*arguments, "--state", "severe"]) == 2
    assert "known are severe_AT, severe_TA" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "column 'state' is missing"),
        ("state,delta_k_mpa_sqrt_m\n", "column 'da_dn_m_per_cycle' is missing"),
        ("state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\nx,1\n", "line 2: has 2 fields"),
        (
            "state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\nx,a,1e-9\n",
            "delta_k_mpa_sqrt_m = 'a' is not a positive",
        ),
        (
            "state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\nx,1,0\n",
            "da_dn_m_per_cycle = '0' is not a positive number",
        ),
        ("state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\nx,1,nan\n", "= 'nan' is not a positive"),
        ("state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\n", "no measured points below the header"),
        ("state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\nx,1,1e-9\n", "no measured point lies on a"),
    ],
)
def test_bad_points_end_the_command_with_one_line_and_status_2(
    result_folder: Path, capsys: pytest.CaptureFixture[str], text: str, expected: str
) -> None:
    file = result_folder / "rail.csv"
    file.write_text(text)
    assert main([str(result_folder), "--experiment", str(file)]) == 2
    captured = capsys.readouterr()
    assert expected in captured.err
    assert captured.err.count("\n") == 1
    assert captured.out == ""


def test_missing_files_end_the_command_with_status_2(
    result_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    points = written_points(result_folder, "2e-7,a,severe_AT,10")
    assert main([str(tmp_path / "none"), "--experiment", str(points)]) == 2
    assert "no such file" in capsys.readouterr().err
    assert main([str(result_folder), "--experiment", str(tmp_path)]) == 2
    assert "cannot be read" in capsys.readouterr().err


def test_a_run_out_moves_nothing_and_is_held_against_the_curve() -> None:
    points = [on_the_law(delta_k, 2.5) for delta_k in (9.0, 15.0, 18.0)]
    low, high = (
        MeasuredPoint("severe_AT", 10.0, ratio * 1e-7, run_out=True) for ratio in (2.4, 2.6)
    )
    result = calibrate(power_law(), [*points, low, high])
    assert result.factor == pytest.approx(2.5, rel=1e-12)
    assert result.notes == ()
    assert result.run_outs == (
        "severe_AT at 10 MPa sqrt(m), below 2.4e-07 m/cycle: "
        "the calibrated curve gives 2.5e-07, contradicts it",
        "severe_AT at 10 MPa sqrt(m), below 2.6e-07 m/cycle: "
        "the calibrated curve gives 2.5e-07, agrees",
    )


def test_a_point_far_from_the_others_is_named_with_what_they_give() -> None:
    points = [on_the_law(13, 1e-6), on_the_law(16, 2.0), on_the_law(20, 3.0)]
    (note,) = calibrate(power_law(), points).notes
    assert (
        "severe_AT at 13 MPa sqrt(m): measured over computed is 1e-06, the others give 2.45" in note
    )
    assert "run_out" in note


def test_scatter_of_a_steel_is_no_outlier_and_no_unit() -> None:
    random = np.random.default_rng(3)
    for _ in range(100):
        ratios = np.exp(random.normal(math.log(5.0), 0.6, 8))
        points = [on_the_law(10 + place, ratio) for place, ratio in enumerate(ratios.tolist())]
        assert calibrate(power_law(), points).notes == ()


@pytest.mark.parametrize(("factor", "unit"), [(352.0, "mm/cycle"), (2e6, "um/cycle")])
def test_a_common_factor_near_a_unit_is_named_as_that_unit(factor: float, unit: str) -> None:
    points = [on_the_law(delta_k, factor * 0.01) for delta_k in (9.0, 15.0, 18.0)]
    (note,) = calibrate(power_law(scale=1e-15), points).notes
    assert f"were they written in {unit}?" in note


def test_delta_k_in_mpa_sqrt_mm_is_named_as_such() -> None:
    points = [replace(on_the_law(k, 1.0), delta_k=k * 31.62) for k in (9.0, 15.0, 18.0)]
    with pytest.raises(SceneError, match=r"fits the computed curve if it was written in MPa sqrt"):
        calibrate(power_law(), points)
    other = [on_the_law(k, 1.0, "undeformed") for k in (9.0, 15.0)]
    result = calibrate(power_law() + power_law("undeformed"), [*points, *other])
    assert result.notes == (
        "Delta-K of severe_AT fits the computed curve if it was written in MPa sqrt(mm)",
    )


def test_a_misspelt_state_is_named_and_another_state_is_not() -> None:
    points = [on_the_law(9, 1.0), on_the_law(9, 1.0, "severe_ATT"), on_the_law(9, 1.0, "severe_TA")]
    left_out = calibrate(power_law(), points).left_out
    assert left_out[0].endswith("no computed growth rate, did you mean 'severe_AT'?")
    assert left_out[1].endswith("no computed growth rate")


def test_points_with_semicolons_and_a_slip_are_said_by_the_command(
    result_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = result_folder / "rail.csv"
    head = "state;delta_k_mpa_sqrt_m;da_dn_m_per_cycle;run_out"
    rows = ("severe_AT;10;1,0e-4;no", "severe_AT;15;3,4e-4;no", "severe_AT;9;1e-4;yes")
    file.write_text("\n".join([head, *rows]))
    assert main([str(result_folder), "--experiment", str(file)]) == 0
    printed = capsys.readouterr().out
    assert "read with semicolons" in printed
    assert "decimal commas in 2 line(s)" in printed
    assert "were they written in mm/cycle?" in printed
    assert "points used: 2 of 3" in printed
    file.write_text(file.read_text().replace("severe_AT;9", "Severe_AT;9"))
    assert main([str(result_folder), "--experiment", str(file)]) == 2
    assert "line 4: state = 'Severe_AT'" in capsys.readouterr().err
