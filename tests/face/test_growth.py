"""Cracks from Python: whole, step by step, and refused where mesh and scene do not match."""

import math
from functools import cache

import numpy as np
import pytest
from matplotlib import pyplot
from mpi4py import MPI

import pearlite_petsc as pp
from tests.face.scenes import small_scene


@cache
def mesh() -> pp.Mesh:
    return pp.build_mesh(small_scene(), "severe_AT")


@cache
def crack() -> pp.Crack:
    return pp.grow_crack(mesh(), delta_k_mpa_sqrt_m=18.0)


def test_a_crack_holds_what_its_history_says() -> None:
    found = crack()
    assert found.stop_reason == "grown"
    assert found.extension_um >= 20.0
    cycles, length = found.history.cycles, found.history.crack_length_um
    assert found.cycles == cycles[-1]
    assert found.extension_um == pytest.approx(length[-1] - length[0])
    grown = np.concatenate([[True], np.diff(length) > 0.0])
    slope = np.polyfit(cycles[grown], length[grown], 1)[0]
    assert found.da_dn_m_per_cycle == pytest.approx(1e-6 * slope, rel=1e-6)
    assert found.path.x_um[0] == pytest.approx(mesh().notch_um[0])
    assert found.path.x_um[-1] == pytest.approx(length[-1])
    ways = np.hypot(np.diff(found.path.x_um), np.diff(found.path.y_um))
    assert found.history.path_length_um[-1] == pytest.approx(ways.sum())


def test_steps_lead_to_the_same_crack() -> None:
    steps = []
    with pp.Growth(mesh(), delta_k_mpa_sqrt_m=18.0, comm=MPI.COMM_SELF) as growth:
        for step in growth:
            steps.append(step)
        assert next(growth, None) is None
        found = growth.crack()
    assert steps[-1].stop_reason == "grown"
    assert all(step.stop_reason is None for step in steps[:-1])
    assert [step.solves for step in steps] == sorted(step.solves for step in steps)
    assert found.da_dn_m_per_cycle == crack().da_dn_m_per_cycle
    assert np.array_equal(found.history.cycles, crack().history.cycles)
    assert growth.crack().path.x_um.tolist() == crack().path.x_um.tolist()


def test_growth_can_be_stopped_on_the_way_and_keeps_its_crack() -> None:
    with pp.Growth(mesh(), delta_k_mpa_sqrt_m=18.0) as growth:
        assert repr(growth) == "<Growth on severe_AT 0 at 18 MPa sqrt(m), growing>"
        for step in growth:
            if step.crack_length_um > 32.0:
                break
        now = growth.crack()
    kept = growth.crack()
    assert now.stop_reason == kept.stop_reason == "stopped"
    assert kept.history.crack_length_um[-1] == step.crack_length_um
    assert kept.extension_um < crack().extension_um
    assert "ended" in repr(growth)
    assert next(growth, None) is None
    growth.close()


def test_growth_that_is_closed_by_hand_keeps_its_crack() -> None:
    growth = pp.Growth(mesh(), delta_k_mpa_sqrt_m=18.0)
    step = next(growth)
    growth.close()
    assert growth.crack().stop_reason == "stopped"
    assert growth.crack().history.crack_length_um[-1] == step.crack_length_um
    assert next(growth, None) is None


def test_an_error_inside_the_block_passes_and_closes() -> None:
    with (
        pytest.raises(RuntimeError, match="of the user"),
        pp.Growth(mesh(), delta_k_mpa_sqrt_m=18.0) as growth,
    ):
        raise RuntimeError("of the user")
    with pytest.raises(pp.PearliteError, match="ended with an error and has no crack"):
        growth.crack()


def test_twice_the_damage_constant_is_twice_the_rate_on_the_same_path() -> None:
    faster = mesh().scene.replace(damage={"c_um5_per_n2": 2 * 4410.0})
    found = pp.grow_crack(mesh(), delta_k_mpa_sqrt_m=18.0, scene=faster)
    assert found.da_dn_m_per_cycle == pytest.approx(2.0 * crack().da_dn_m_per_cycle, rel=1e-9)
    assert np.array_equal(found.path.x_um, crack().path.x_um)
    assert found.scene["damage"]["c_um5_per_n2"] == 8820.0


def test_other_springs_grow_on_the_same_mesh_as_on_one_of_their_own() -> None:
    matched = mesh().scene.replace(material={"springs": "matched"})
    here = pp.grow_crack(mesh(), delta_k_mpa_sqrt_m=18.0, scene=matched)
    own = pp.grow_crack(pp.build_mesh(matched, "severe_AT"), delta_k_mpa_sqrt_m=18.0)
    assert here.da_dn_m_per_cycle == own.da_dn_m_per_cycle
    assert here.da_dn_m_per_cycle != crack().da_dn_m_per_cycle


def test_a_crack_below_the_threshold_arrests_and_has_no_rate() -> None:
    found = pp.grow_crack(mesh(), delta_k_mpa_sqrt_m=1.0)
    assert found.stop_reason == "arrested"
    assert math.isnan(found.da_dn_m_per_cycle)
    assert math.isnan(found.tortuosity)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"states": ["undeformed"]}, "state severe_AT is unknown, known are undeformed"),
        ({"microstructure": {"seed": 2}}, "[microstructure] is not the one that mesh severe_AT 0"),
        ({"window": {"height_um": 90.0}}, "[window] is not the one"),
        ({"elements": {"width_um": 2.4}}, "[elements] is not the one"),
        ({"states": {"severe_AT": {"shear_strain": 20.0}}}, "[states.severe_AT] is not the one"),
    ],
)
def test_a_scene_with_another_mesh_or_without_the_state_is_refused(
    change: dict[str, object], message: str
) -> None:
    scene = mesh().scene.replace(**change)
    with pytest.raises(pp.PearliteError) as refused:
        pp.grow_crack(mesh(), delta_k_mpa_sqrt_m=18.0, scene=scene)
    assert message in str(refused.value)


def test_delta_k_has_its_unit_in_the_name_and_its_limits() -> None:
    with pytest.raises(TypeError):
        pp.grow_crack(mesh(), 18.0)  # type: ignore[misc]
    with pytest.raises(TypeError):
        pp.grow_crack(mesh(), delta_k=18e3)  # type: ignore[call-arg]
    with pytest.raises(pp.PearliteError, match="delta_k_mpa_sqrt_m value 1 = 18000"):
        pp.grow_crack(mesh(), delta_k_mpa_sqrt_m=18e3)
    with pytest.raises(TypeError, match="a mesh of build_mesh is needed, got Scene"):
        pp.grow_crack(small_scene(), delta_k_mpa_sqrt_m=18.0)  # type: ignore[arg-type]


def test_a_crack_draws_its_path_and_its_history() -> None:
    axes = crack().plot()
    notch, path = axes.lines
    assert notch.get_label() == "notch"
    assert path.get_xdata().tolist() == crack().path.x_um.tolist()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [µm]", "y [µm]")
    _, given = pyplot.subplots()
    assert crack().plot_history(given) is given
    steps, points, line = given.lines
    assert len(points.get_xdata()) == len(np.unique(crack().history.crack_length_um))
    assert steps.get_ydata().tolist() == crack().history.crack_length_um.tolist()
    x, y = line.get_data()
    slope = (y[1] - y[0]) / (x[1] - x[0])
    assert 1e-6 * slope == pytest.approx(crack().da_dn_m_per_cycle)
    pyplot.close("all")


def test_rates_are_those_between_the_moments_at_which_the_crack_got_longer() -> None:
    rates = crack().rates
    assert rates.crack_length_um.tolist() == sorted(set(crack().history.crack_length_um.tolist()))
    assert np.isnan(rates.secant_m_per_cycle[0])
    steps = 1e-6 * np.diff(rates.crack_length_um) / np.diff(rates.cycles)
    assert rates.secant_m_per_cycle[1:] == pytest.approx(steps)
    smooth = rates.polynomial_m_per_cycle[3:-3]
    assert len(smooth) == 0 or np.isfinite(smooth).all()


def test_a_crack_is_a_table_and_a_text() -> None:
    columns = crack().to_dict()
    assert set(columns["state"]) == {"severe_AT"}
    assert set(columns["delta_k_mpa_sqrt_m"]) == {18.0}
    assert {len(values) for values in columns.values()} == {len(crack().history)}
    assert repr(crack()).startswith("<Crack severe_AT 0 at 18 MPa sqrt(m): grown, ")
    assert repr(crack()).endswith(" m/cycle>")
