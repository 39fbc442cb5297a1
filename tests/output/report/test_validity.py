import dataclasses
import math

from numpy.testing import assert_allclose

from pearlite_petsc.fatigue.outcome import Effort, Outcome, StopReason
from pearlite_petsc.output.doubts import FAST, SHORT_LIFE
from pearlite_petsc.output.report.validity import task_warnings, validity_warnings, zone_rows
from tests.output import synthetic
from tests.scenes import STATES, default_scene

ELEMENTS = default_scene().elements


def test_the_plastic_zone_at_20_in_undeformed_pearlite_is_144_um() -> None:
    scene = default_scene(loading={"delta_k": (20e3,)})
    row = next(row for row in zone_rows(scene) if row.state == "undeformed")
    assert_allclose(row.plastic_zone, 144.1, atol=0.05)
    assert_allclose(row.colonies, 144.1 / 15.0, atol=0.01)
    assert_allclose(row.window_share, 144.1 / 200.0, atol=1e-3)


def test_the_edge_crack_passes_the_yield_stress_above_about_15() -> None:
    scene = default_scene(
        loading={"kind": "edge_crack", "delta_k": (10e3, 14e3, 16e3, 20e3), "load_ratio": 0.0},
        states=(STATES["undeformed"],),
    )
    shares = [row.stress_share for row in zone_rows(scene)]
    assert shares[1] < 1.0 < shares[3]
    assert any(
        "from ΔK = " in text and "remote stress" in text for text in validity_warnings(scene)
    )


def test_the_stress_is_the_largest_of_the_cycle() -> None:
    low, high = (
        zone_rows(default_scene(loading={"load_ratio": ratio}))[0].stress for ratio in (0.0, 0.5)
    )
    assert_allclose(high, 2.0 * low)


def test_a_scene_within_all_limits_has_no_warning() -> None:
    strong = dataclasses.replace(STATES["severe_AT"], yield_stress=5000.0)
    assert validity_warnings(default_scene(states=(strong,), loading={"delta_k": (8e3,)})) == []


def test_tasks_that_ended_otherwise_or_fell_back_are_named_with_the_reason() -> None:
    good = synthetic.outcomes(delta_k=(8e3,), meshes=1)
    assert task_warnings(good, ELEMENTS) == {}
    failed = Outcome("severe_AT", 1, 8e3, StopReason.FAILED, message="no equilibrium")
    arrested = Outcome("undeformed", 2, 8e3, StopReason.ARRESTED, da_dn=math.nan)
    fallback = dataclasses.replace(good[0], effort=Effort(counters={"direct": 3.0}))
    found = task_warnings([failed, arrested, fallback], ELEMENTS)
    assert found["failed"] == ["severe_AT_m1_dk8: no equilibrium"]
    names = [name for names in found.values() for name in names]
    assert "undeformed_m2_dk8" in names
    assert "undeformed_m0_dk8 (3)" in names


def test_cracks_faster_than_fatigue_are_named() -> None:
    task = synthetic.outcomes(meshes=1)[0]
    short = dataclasses.replace(task, cycles=0.0024, da_dn=25e3)
    fast = dataclasses.replace(task, mesh_index=1, cycles=25.0, da_dn=2.5)
    fine = dataclasses.replace(task, mesh_index=2, cycles=25.0, da_dn=1.9)
    assert task_warnings([short, fast, fine], ELEMENTS) == {
        SHORT_LIFE: ["undeformed_m0_dk8 (0.0024 cycles)"],
        FAST: ["undeformed_m1_dk8 (25 cycles)"],
    }
