import dataclasses
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from scipy.stats import ttest_ind

from pearlite_petsc.fatigue.damage import straight_crack_factor
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.null_model import null_rate, null_ratio
from pearlite_petsc.output.statistics import (
    common_levels,
    mean_difference,
    mean_with_interval,
    rate_curves,
    rate_ratio,
)
from tests.output import synthetic
from tests.scenes import STATES


def task(state: str, mesh: int, delta_k: float, da_dn: float, **changes: object) -> Outcome:
    outcome = Outcome(state, mesh, delta_k, StopReason.GROWN, da_dn=da_dn)
    return dataclasses.replace(outcome, **changes)


def test_the_mean_is_geometric_and_the_scatter_its_geometric_deviation() -> None:
    tasks = [task("a", mesh, 8e3, rate) for mesh, rate in enumerate((1.0, 2.0, 4.0))]
    (curve,) = rate_curves(tasks, ["a", "b"])
    assert_allclose(curve.mean, [2.0])
    assert_allclose(curve.factor, [2.0])
    assert curve.grown.tolist() == [3]


@pytest.mark.parametrize(
    "reason", [r for r in StopReason if r is not StopReason.GROWN], ids=lambda r: r.value
)
def test_a_crack_that_did_not_grow_through_is_in_no_mean(reason: StopReason) -> None:
    tasks = [task("a", 0, 8e3, 2.0), task("a", 1, 8e3, 50.0, stop_reason=reason)]
    (curve,) = rate_curves(tasks, ["a"])
    assert_allclose(curve.mean, [2.0])
    assert math.isnan(curve.factor[0])
    assert (curve.grown.tolist(), curve.tasks.tolist()) == ([1], [2])


def test_the_ratio_of_rates_has_welchs_interval_over_meshes() -> None:
    rng = np.random.default_rng(1)
    logs = {"a": 0.7 + 0.3 * rng.standard_normal(5), "b": 0.1 * rng.standard_normal(4)}
    tasks = [
        task(state, mesh, level, float(np.exp(value)) * (level / 8e3) ** 3)
        for state, values in logs.items()
        for mesh, value in enumerate(values)
        for level in (8e3, 16e3)
    ]
    ratio = rate_ratio(tasks, "a", "b", (8e3, 16e3))

    # The interval's ends are the shifts of one sample that Welch's test finds just significant.
    def significance(shift: float) -> float:
        return ttest_ind(logs["a"] - shift, logs["b"], equal_var=False).pvalue - 0.05

    middle = logs["a"].mean() - logs["b"].mean()
    interval = (
        brentq(significance, middle - 3.0, middle),
        brentq(significance, middle, middle + 3.0),
    )
    assert_allclose(np.log(ratio.value), logs["a"].mean() - logs["b"].mean(), rtol=1e-9)
    assert_allclose(np.log([ratio.low, ratio.high]), interval, rtol=1e-6)


@pytest.mark.parametrize("reason", [StopReason.ARRESTED, StopReason.MAX_SOLVES, None])
def test_a_level_at_which_one_mesh_did_not_grow_compares_nothing(reason: StopReason | None) -> None:
    """A state whose slow mesh is missing at the low level must not look fast for it."""
    low = {"a": (2.0, 2.0, 2.0), "b": (1.0, 1.0, 1e-3)}
    tasks = [
        task(s, mesh, 8e3, rate) for s, rates in low.items() for mesh, rate in enumerate(rates)
    ]
    tasks += [task(s, mesh, 16e3, 8.0 * low[s][0]) for s in low for mesh in range(3)]
    slow = next(o for o in tasks if o.da_dn == 1e-3)
    rest = [o for o in tasks if o is not slow]
    ended = [] if reason is None else [dataclasses.replace(slow, stop_reason=reason)]
    assert common_levels([*rest, *ended], "a", "b", (8e3, 16e3)) == [16e3]
    assert_allclose(rate_ratio([*rest, *ended], "a", "b", (8e3, 16e3)).value, 2.0, rtol=1e-12)


def test_bounds_count_for_the_first_state_only() -> None:
    tasks = [task(state, mesh, 8e3, 1.0) for state in "ab" for mesh in range(2)]
    tasks[0] = dataclasses.replace(tasks[0], stop_reason=StopReason.BOUNDARY)
    assert common_levels(tasks, "a", "b", (8e3,)) == []
    assert common_levels(tasks, "a", "b", (8e3,), bounds=True) == [8e3]
    assert common_levels(tasks, "b", "a", (8e3,), bounds=True) == []


def test_levels_without_a_crack_in_either_state_are_left_out() -> None:
    tasks = [task("a", 0, 8e3, 1.0), task("a", 0, 16e3, 99.0), task("b", 0, 8e3, 4.0)]
    assert_allclose(rate_ratio(tasks, "a", "b", (8e3, 16e3)).value, 0.25)
    assert math.isnan(rate_ratio(tasks, "a", "c", (8e3, 16e3)).value)


def test_one_mesh_a_side_has_a_value_but_no_interval() -> None:
    estimate = mean_difference([3.0], [1.0, 1.5])
    assert estimate.value == 1.75
    assert math.isnan(estimate.low)
    assert math.isnan(mean_with_interval([2.0]).high)
    assert mean_with_interval([1.0, 3.0], 0.5).half_width == pytest.approx(1.0)  # t = 1
    assert math.isnan(mean_with_interval([]).value)


def test_the_null_model_knows_only_threshold_and_yield_stress() -> None:
    delta_k = np.array([2e3, 10e3])
    severe, undeformed = STATES["severe_AT"], STATES["undeformed"]
    factor = straight_crack_factor(np.array([0.23, 0.5]))
    assert_allclose(null_rate(delta_k, severe), [0.0, factor[0] * 7700.0**3 / 1024.0])
    ratio = null_ratio(delta_k, severe, undeformed)
    assert math.isnan(ratio[0])
    assert_allclose(ratio[1], factor[0] / factor[1] * (7.7 / 5.0) ** 3 * 470.0 / 1024.0)


def test_synthetic_rates_are_recovered() -> None:
    tasks = synthetic.outcomes(meshes=200, delta_k=(10e3, 20e3))
    ratio = rate_ratio(tasks, "severe_AT", "undeformed", (10e3, 20e3))
    assert ratio.low < synthetic.SPEED["severe_AT"] < ratio.high
    assert ratio.high / ratio.low < 1.25
