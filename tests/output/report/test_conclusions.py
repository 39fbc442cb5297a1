import dataclasses
import math

import numpy as np

from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.null_model import null_rate
from pearlite_petsc.output.report.conclusions import (
    Verdict,
    conclusions,
    microstructure_factor,
)
from tests.output import synthetic
from tests.scenes import STATES, default_scene


def verdicts(outcomes: list[Outcome], **changes: object) -> list[Verdict]:
    return [c.verdict for c in conclusions(default_scene(**changes), outcomes)]


def with_speed(outcomes: list[Outcome], state: str, factor: float) -> list[Outcome]:
    return [
        dataclasses.replace(o, da_dn=o.da_dn * factor) if o.state == state else o for o in outcomes
    ]


def test_rates_as_the_source_has_them_bear_its_statements_out() -> None:
    faster, hardening, tortuosity, alike, slower = verdicts(synthetic.outcomes(meshes=40))
    assert (faster, tortuosity, alike, slower) == (Verdict.YES,) * 4
    assert hardening is Verdict.OPEN, "the law divides by the yield stress: no finding"


def test_few_meshes_with_large_scatter_decide_nothing() -> None:
    faster = verdicts(synthetic.outcomes(meshes=3))[0]
    assert faster in (Verdict.TENDENCY, Verdict.DOUBT)
    alone = verdicts(synthetic.outcomes(meshes=1))
    assert set(alone) == {Verdict.OPEN}, "one mesh has no interval"


def test_a_contrary_result_is_said_to_be_one() -> None:
    contrary = synthetic.outcomes(meshes=40)
    for state, factor in (("severe_AT", 0.2), ("severe_TA", 40.0)):
        contrary = with_speed(contrary, state, factor)
    faster, _, _, alike, slower = verdicts(contrary)
    assert (faster, alike, slower) == (Verdict.NO,) * 3


def test_a_state_faster_by_its_threshold_alone_is_not_faster_by_orientation() -> None:
    """Rates as the null model gives them leave nothing to the microstructure."""
    scene = default_scene()
    base = synthetic.outcomes(meshes=4, delta_k=(6e3,))
    rates = {name: float(null_rate(np.array(6e3), state)) for name, state in STATES.items()}
    null = [
        dataclasses.replace(o, da_dn=rates[o.state] * 1e-12 * (1.0 + 0.01 * o.mesh_index))
        for o in base
    ]
    scene = default_scene(loading={"delta_k": (6e3,)})
    ratio, expected = microstructure_factor(scene, null, "severe_AT", "undeformed")
    assert ratio.value > 10.0
    assert abs(ratio.value / expected - 1.0) < 1e-9
    assert conclusions(scene, null)[0].verdict is not Verdict.YES


def test_without_grown_cracks_nothing_is_decided_and_nothing_is_nan() -> None:
    stuck = [
        dataclasses.replace(o, stop_reason=StopReason.MAX_SOLVES, tortuosity=None)
        for o in synthetic.outcomes(meshes=2)
    ]
    for outcomes in ([], stuck):
        found = conclusions(default_scene(), outcomes)
        assert {c.verdict for c in found} == {Verdict.OPEN}
        assert not any("nan" in c.numbers for c in found)


def test_cracks_that_ran_into_the_windows_edge_bound_the_rate_across_the_lamellae() -> None:
    tasks = [
        dataclasses.replace(o, stop_reason=StopReason.BOUNDARY) if o.state == "severe_TA" else o
        for o in synthetic.outcomes(meshes=20)
    ]
    slower = conclusions(default_scene(), tasks)[-1]
    assert slower.verdict is Verdict.YES
    assert "80 of 80 cracks turned" in slower.numbers
    others = conclusions(default_scene(), [o for o in tasks if o.state != "severe_TA"])
    assert others[-1].verdict is Verdict.OPEN


def test_states_compare_only_where_every_mesh_grew_and_the_number_of_levels_is_said() -> None:
    tasks = synthetic.outcomes(meshes=4)
    # One slow crack left at the lowest load, as if all others had arrested there.
    tasks = [
        dataclasses.replace(o, stop_reason=StopReason.ARRESTED, da_dn=math.nan, tortuosity=None)
        if (o.state, o.delta_k) == ("undeformed", 8e3) and o.mesh_index
        else o
        for o in tasks
    ]
    slow = with_speed([o for o in tasks if o.delta_k == 8e3], "undeformed", 1e-4)
    tasks = slow + [o for o in tasks if o.delta_k != 8e3]
    found = conclusions(default_scene(), tasks)
    for place in (0, 2, 4):
        assert "at 3 of 4 ΔK (12, 18, 25 MPa√m)" in found[place].numbers
    assert "at 4 of 4 ΔK (8, 12, 18, 25 MPa√m)" in found[3].numbers
    without = conclusions(default_scene(), [o for o in tasks if o.delta_k != 8e3])
    assert [c.numbers for c in without[:3]] == [c.numbers for c in found[:3]]


def test_a_scene_with_one_state_decides_nothing() -> None:
    tasks = [o for o in synthetic.outcomes() if o.state == "severe_AT"]
    found = conclusions(default_scene(states=(STATES["severe_AT"],)), tasks)
    assert {c.verdict for c in found} == {Verdict.OPEN}
    assert all(c.numbers for c in found), "each says why"
