"""Comparison of cracks with a reference: shares, errors, fronts and verdicts by hand."""

from dataclasses import replace

import numpy as np
import pytest

from pearlite_petsc.errors import MeshError
from pearlite_petsc.fatigue.outcome import CrackShape, Effort, Outcome, StopReason
from pearlite_petsc.studies.benchmarks.cracks import Grown, Key, Plan, compare, geometric_mean, grow
from pearlite_petsc.studies.benchmarks.pareto import QUICK_WINDOW, Measured, dominating
from pearlite_petsc.studies.benchmarks.stability_studies import (
    CONVERGES,
    FALLS_BACK,
    STOPS,
    WRONG,
    dropping,
    judged,
    measured,
)
from pearlite_petsc.tessellation import assemble

TWENTY = [[i, i + 1] for i in range(20)]


def outcome(
    da_dn: float, broken: list[list[int]], reason: StopReason = StopReason.GROWN
) -> Outcome:
    pairs = np.array(broken, dtype=np.int64).reshape(-1, 2)
    shape = CrackShape(np.zeros((1, 2)), pairs)
    return Outcome("severe_AT", 0, 12e3, reason, da_dn=da_dn, effort=Effort(solves=30), shape=shape)


def cracks(*outcomes: Outcome) -> dict[Key, Grown]:
    return {
        ("severe_AT", place, 12.0): Grown(item, "", False, 2.0)
        for place, item in enumerate(outcomes)
    }


def test_error_is_of_the_same_paths_only_and_the_mean_is_of_all() -> None:
    reference = cracks(*[outcome(1.0, TWENTY)] * 3)
    other = cracks(
        outcome(0.98, TWENTY), outcome(0.92, TWENTY), outcome(4.0, [[100, 101], *TWENTY[:9]])
    )
    found = compare(other, reference)
    assert found.same_path == 2
    assert found.error == pytest.approx(np.sqrt(0.02 * 0.08))
    assert found.bias == pytest.approx(np.sqrt(0.98 * 0.92) - 1.0)
    assert found.mean_error == pytest.approx((0.98 * 0.92 * 4.0) ** (1 / 3) - 1.0)
    assert found.common == pytest.approx((1.0 + 1.0 + 9 / 21) / 3)
    assert found.solves_per_break == pytest.approx(90 / 50)
    assert found.seconds == 2.0


def test_cracks_with_19_of_20_common_interfaces_are_the_same() -> None:
    reference = cracks(outcome(1.0, TWENTY))
    assert compare(cracks(outcome(1.0, TWENTY[:-1])), reference).same_path == 1
    assert compare(cracks(outcome(1.0, TWENTY[:-2])), reference).same_path == 0


def test_crack_that_failed_counts_as_not_grown_and_on_another_path() -> None:
    reference = cracks(outcome(1.0, TWENTY))
    key = next(iter(reference))
    found = compare({key: Grown(None, "MeshError: x", True, 1.0)}, reference)
    assert (found.tasks, found.same_path, found.not_grown) == (1, 0, 1)
    assert np.isnan(found.error)


def test_geometric_mean_has_a_symmetric_interval_in_the_logarithm() -> None:
    mean, low, high = geometric_mean(np.array([0.01, 0.04]))
    assert mean == pytest.approx(0.02)
    assert mean / low == pytest.approx(high / mean) == pytest.approx(2.0)


def test_only_a_setting_better_in_both_and_on_the_paths_beats_the_default() -> None:
    found = compare(cracks(outcome(0.9, TWENTY)), cracks(outcome(1.0, TWENTY)))

    def setting(name: str, seconds: float, error: float, common: float = 0.99) -> Measured:
        values = replace(found, seconds=seconds, error=error, common=common)
        return Measured("group", name, (), values)

    settings = [
        setting("default", 1.0, 0.05),
        setting("cheaper", 0.5, 0.06),
        setting("more accurate", 2.0, 0.01),
        setting("both", 0.5, 0.01),
        setting("hardly", 0.99, 0.0499),
        setting("on other paths", 0.5, 0.01, 0.9),
    ]
    assert [item.name for item in dominating(settings)] == ["both"]


def test_the_time_of_a_setting_is_the_shortest_of_its_rounds() -> None:
    found = compare(cracks(outcome(0.9, TWENTY)), cracks(outcome(1.0, TWENTY)))
    rounds = [Measured("g", "s", (), replace(found, seconds=value)) for value in (0.7, 0.5, 0.6)]
    least = rounds[2].least(rounds[1].least(rounds[0]))
    assert (least.comparison.seconds, least.error) == (0.5, found.error)


@pytest.mark.parametrize(
    "other, verdict",
    [
        (outcome(0.95, TWENTY), CONVERGES),
        (outcome(0.85, TWENTY), WRONG),
        (replace(outcome(0.95, TWENTY), effort=Effort(counters={"direct": 1.0})), FALLS_BACK),
        (outcome(1.0, TWENTY, StopReason.BOUNDARY), STOPS),
    ],
)
def test_verdict_follows_error_fallbacks_and_stop_reason(other: Outcome, verdict: str) -> None:
    reference = cracks(outcome(1.0, TWENTY))
    assert judged("study", "1", cracks(other), reference).outcome == verdict


def test_errors_with_a_name_are_stops_and_others_are_crashes() -> None:
    reference = cracks(outcome(1.0, TWENTY))
    key = next(iter(reference))
    named, crash = (Grown(None, "error", named, 1.0) for named in (True, False))
    assert judged("study", "1", {key: named}, reference).outcome == STOPS
    assert judged("study", "1", {key: crash}, reference).outcome == WRONG


def test_measure_that_is_not_a_number_is_wrong_and_a_refusal_is_a_stop() -> None:
    def refuse() -> float:
        raise MeshError("no mesh")

    assert measured("study", 1.0, lambda: float("nan")).outcome == WRONG
    assert measured("study", 1.0, lambda: 1.09).outcome == CONVERGES
    assert measured("study", 1.0, refuse).outcome == STOPS


def test_study_of_facets_leaves_the_tessellation_as_it_was() -> None:
    before = assemble.DROPPING
    with pytest.raises(MeshError), dropping(0.5):
        assert assemble.DROPPING == 0.5
        raise MeshError("on the way")
    assert before == assemble.DROPPING


def test_tolerance_that_does_not_matter_gives_the_same_crack() -> None:
    plan = Plan(("moderate_AT",), (0,), (12.0,), QUICK_WINDOW)
    found = compare(grow(plan), grow(plan, ("solver.method=direct",)))
    assert found.same_path == found.tasks == 1
    assert found.not_grown == 0
    assert found.error < 1e-4
