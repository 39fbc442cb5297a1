"""Means and scatter over the meshes of a state."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.outcome import Outcome, StopReason


@dataclass(frozen=True, slots=True, eq=False)
class RateCurve:
    """Growth rate of one state over delta_k, over the tasks that grew to the wanted extension.

    Attributes:
        state: Name.
        delta_k: Every one that the state has tasks for, rising [MPa sqrt(um)]; (d,).
        mean: Geometric mean of da/dN [um/cycle], NaN where no task grew; (d,).
        factor: Geometric standard deviation, >= 1, NaN below two tasks; (d,).
        grown: Tasks in the mean; (d,).
        tasks: Tasks in all; (d,).
    """

    state: str
    delta_k: FloatArray
    mean: FloatArray
    factor: FloatArray
    grown: IntArray
    tasks: IntArray


@dataclass(frozen=True, slots=True)
class Estimate:
    """A mean with its confidence interval over meshes, of 95 % unless another level was asked for.

    Attributes:
        value: The mean (NaN without data).
        low, high: Ends of the interval, NaN below two meshes a side.
    """

    value: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Half the width of the interval."""
        return 0.5 * (self.high - self.low)


def counts(outcome: Outcome, bounds: bool = False) -> bool:
    """Return whether a task's rate stands for the wanted extension.

    Args:
        outcome: The task.
        bounds: Count cracks that ran into the window's boundary as well: they left the x-direction
            for good, so that the rate until then is an upper bound.
    """
    grown = outcome.stop_reason is StopReason.GROWN
    bound = bounds and outcome.stop_reason is StopReason.BOUNDARY
    return (grown or bound) and outcome.da_dn > 0.0


def rate_curves(outcomes: Sequence[Outcome], states: Sequence[str]) -> list[RateCurve]:
    """Return the curve of each state that has tasks, in the order of ``states``."""
    curves = []
    for state in states:
        own = [o for o in outcomes if o.state == state]
        if not own:
            continue
        levels = sorted({o.delta_k for o in own})
        logs = [
            np.log([o.da_dn for o in own if o.delta_k == level and counts(o)]) for level in levels
        ]
        curves.append(
            RateCurve(
                state=state,
                delta_k=np.array(levels),
                mean=np.array([np.exp(log.mean()) if len(log) else np.nan for log in logs]),
                factor=np.array(
                    [np.exp(log.std(ddof=1)) if len(log) > 1 else np.nan for log in logs]
                ),
                grown=np.array([len(log) for log in logs]),
                tasks=np.array([sum(o.delta_k == level for o in own) for level in levels]),
            )
        )
    return curves


def rate_ratio(
    outcomes: Sequence[Outcome],
    state: str,
    other: str,
    delta_k: Sequence[float],
    bounds: bool = False,
) -> Estimate:
    """Return how many times faster one state grows than another, with its interval.

    Each mesh gives one number, the mean of log(da/dN) over the common levels; meshes are
    independent, so the interval is Welch's on those.

    Args:
        outcomes: Tasks of one scene.
        state, other: Names.
        delta_k: Levels to take [MPa sqrt(um)], of which the ``common_levels`` are used.
        bounds: See ``counts``; for ``state`` only, so that the ratio is an upper bound.
    """
    levels = common_levels(outcomes, state, other, delta_k, bounds)
    difference = _difference(*(_log_rates(outcomes, name, levels) for name in (state, other)))
    return Estimate(*np.exp([difference.value, difference.low, difference.high]).tolist())


def common_levels(
    outcomes: Sequence[Outcome],
    state: str,
    other: str,
    delta_k: Sequence[float],
    bounds: bool = False,
) -> list[float]:
    """Return the delta_k at which every mesh of both states has a rate that counts.

    Where a part of the meshes grew, their mean is that of the fast ones and compares with nothing.

    Args:
        outcomes: Tasks of one scene; a mesh that a state has at any level is wanted at each.
        state, other: Names.
        delta_k: Levels to choose from [MPa sqrt(um)].
        bounds: See ``counts``; for ``state`` only.
    """

    def is_complete(name: str, level: float) -> bool:
        own = [o for o in outcomes if o.state == name]
        here = [o for o in own if o.delta_k == level and counts(o, bounds and name == state)]
        return bool(here) and {o.mesh_index for o in here} == {o.mesh_index for o in own}

    return [v for v in delta_k if is_complete(state, v) and is_complete(other, v)]


def mean_difference(first: Sequence[float], second: Sequence[float]) -> Estimate:
    """Return the difference of two means with Welch's interval."""
    return _difference(np.array(first, dtype=float), np.array(second, dtype=float))


def mean_with_interval(values: Sequence[float], level: float = 0.95) -> Estimate:
    """Return the mean with Student's interval of a level of confidence.

    >>> found = mean_with_interval([1.0, 2.0, 3.0])
    >>> found.value, round(found.half_width, 3)
    (2.0, 2.484)
    """
    data = np.array(values, dtype=float)
    if not len(data):
        return Estimate(np.nan, np.nan, np.nan)
    if len(data) < 2:
        return Estimate(float(data[0]), np.nan, np.nan)
    quantile = student.ppf(0.5 + 0.5 * level, len(data) - 1)
    half = float(quantile * data.std(ddof=1) / np.sqrt(len(data)))
    return Estimate(float(data.mean()), float(data.mean()) - half, float(data.mean()) + half)


def _log_rates(outcomes: Sequence[Outcome], state: str, levels: Sequence[float]) -> FloatArray:
    """Return the mean log rate of each mesh over levels at which all its rates count."""
    own = [o for o in outcomes if o.state == state and o.delta_k in levels]
    meshes = sorted({o.mesh_index for o in own})
    return np.array([np.mean([np.log(o.da_dn) for o in own if o.mesh_index == m]) for m in meshes])


def _difference(first: FloatArray, second: FloatArray) -> Estimate:
    if not len(first) or not len(second):
        return Estimate(np.nan, np.nan, np.nan)
    value = float(first.mean() - second.mean())
    if len(first) < 2 or len(second) < 2:
        return Estimate(value, np.nan, np.nan)
    parts = np.array([x.var(ddof=1) / len(x) for x in (first, second)])
    spread = float(parts.sum())
    if spread == 0.0:
        return Estimate(value, value, value)
    freedom = spread**2 / float(np.sum(parts**2 / [len(first) - 1, len(second) - 1]))
    half = float(student.ppf(0.975, freedom) * np.sqrt(spread))
    return Estimate(value, value - half, value + half)
