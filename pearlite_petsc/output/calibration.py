"""The damage constant C that makes computed growth rates agree with measured ones.

The damage rate is proportional to C (Eq. (28)-(31)), so C scales the cycles of a crack and
nothing else: its path and all stresses stay, da/dN is proportional to C. The C that fits best in
the logarithm is the old one times the geometric mean of measured over computed rates; no new
simulation is needed.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np
from scipy.stats import t as student

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.experiment import RUN_OUT, MeasuredPoint
from pearlite_petsc.output.plausibility import delta_k_unit, outliers, rate_unit
from pearlite_petsc.output.statistics import counts
from pearlite_petsc.output.tables import UM_PER_M, delta_k_in_mpa_sqrt_m

CONFIDENCE = 0.95

NEAR = 0.9
"""Likeness from which a state's name is taken for a slip; severe_AT and severe_TA have 0.89."""


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """Rates of one state: delta_k [MPa sqrt(m)], (k,); log of da_dn [m/cycle], (meshes, k)."""

    delta_k: FloatArray
    log_rate: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """The factor on C.

    Attributes:
        factor: New C over the old one.
        error_points, error_meshes: Standard errors of its logarithm, from the scatter of the
            measured points and of the computed meshes; NaN where there is only one.
        interval: Confidence interval of the factor, NaN where an error is.
        ratios: Measured over computed rate of each point used.
        left_out: Points not used, each with the reason.
        ungrown: Computed delta_k and meshes not used, each with the reason.
        run_outs: Run-outs, each with what the calibrated curve says of it.
        notes: What looks like a slip: points far from the others, units.
    """

    factor: float
    error_points: float
    error_meshes: float
    interval: tuple[float, float]
    ratios: tuple[tuple[MeasuredPoint, float], ...]
    left_out: tuple[str, ...]
    ungrown: tuple[str, ...]
    run_outs: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def error(self) -> float:
        """Standard error of the factor's logarithm."""
        return math.hypot(self.error_points, self.error_meshes)


def curves(outcomes: Iterable[Outcome]) -> tuple[dict[str, Curves], tuple[str, ...]]:
    """Return the computed curve of each state, and what is not on it and why.

    A mean rate over meshes needs the same meshes at every delta_k. Where one arrested, the mean is
    0 and has no logarithm: that delta_k is left out. A mesh without a rate for another reason is
    left out as a whole.
    """
    by_state: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        by_state.setdefault(outcome.state, []).append(outcome)
    found, ungrown = {}, []
    for state, own in by_state.items():
        delta_k, meshes = set(), {o.mesh_index for o in own}
        for value in sorted({o.delta_k for o in own}):
            here = [o for o in own if o.delta_k == value]
            arrested = sum(o.stop_reason is StopReason.ARRESTED for o in here)
            if arrested or not any(counts(o) for o in here):
                where = f"{state} at {delta_k_in_mpa_sqrt_m(value):g} MPa sqrt(m)"
                reason = f"{arrested} of {len(here)} meshes arrested" if arrested else "no rate"
                ungrown.append(f"{where}: {reason}")
            else:
                delta_k.add(value)
        for mesh in sorted(meshes):
            rated = {o.delta_k for o in own if o.mesh_index == mesh and counts(o)}
            if not delta_k <= rated:
                at = delta_k_in_mpa_sqrt_m(min(delta_k - rated))
                ungrown.append(f"{state} mesh {mesh}: no rate at {at:g} MPa sqrt(m)")
                meshes.discard(mesh)
        if delta_k and meshes:
            rates = {(o.mesh_index, o.delta_k): o.da_dn / UM_PER_M for o in own if counts(o)}
            levels = sorted(delta_k)
            table = np.log([[rates[mesh, value] for value in levels] for mesh in sorted(meshes)])
            found[state] = Curves(np.array([*map(delta_k_in_mpa_sqrt_m, levels)]), table)
    return found, tuple(ungrown)


def calibrate(outcomes: Iterable[Outcome], points: Sequence[MeasuredPoint]) -> Calibration:
    """Return the factor on C that brings computed rates to the measured ones, in the log mean.

    Each mesh's curve is interpolated in log-log, never extrapolated. Points and meshes are two
    independent sources of scatter; their errors add, degrees of freedom by Welch-Satterthwaite.
    A run-out is no rate: it is held against the calibrated curve and moves nothing.

    Raises:
        SceneError: If no measured point lies on a computed curve.
    """
    computed, ungrown = curves(outcomes)
    used: list[tuple[MeasuredPoint, FloatArray]] = []
    left_out = []
    for point in (point for point in points if not point.run_out):
        reason = _outside(point, computed)
        if reason:
            left_out.append(f"{_place(point)}: {reason}")
        else:
            rates = _interpolated(computed[point.state], point.delta_k)
            used.append((point, math.log(point.da_dn) - rates))
    if not used:
        reasons = "; ".join([*left_out[:3], *ungrown[:3]]) or "there are none"
        slips = "".join(f"; {note}" for note in _delta_k_slips(points, computed))
        raise SceneError(f"no measured point lies on a computed curve: {reasons}{slips}")
    logs = np.array([np.mean(ratio) for _, ratio in used])
    # Sums, not means, of a state's points: a state counts with the points that it has.
    of_meshes: dict[str, FloatArray] = {}
    for point, ratio in used:
        of_meshes[point.state] = of_meshes.get(point.state, 0.0) + ratio / len(used)
    parts = [(_variance_of_mean(logs), len(logs) - 1)]
    parts += [(_variance_of_mean(ratio), len(ratio) - 1) for ratio in of_meshes.values()]
    log_factor = float(np.mean(logs))
    half = _half_width(parts)
    factor = math.exp(log_factor)
    ratios = tuple((point, math.exp(np.mean(ratio))) for point, ratio in used)
    return Calibration(
        factor=factor,
        error_points=math.sqrt(parts[0][0]),
        error_meshes=math.sqrt(sum(variance for variance, _ in parts[1:])),
        interval=(math.exp(log_factor - half), math.exp(log_factor + half)),
        ratios=ratios,
        left_out=tuple(left_out),
        ungrown=ungrown,
        run_outs=tuple(_held(point, computed, factor) for point in points if point.run_out),
        notes=(*_rate_slips(ratios), *_delta_k_slips(points, computed)),
    )


def _place(point: MeasuredPoint) -> str:
    return f"{point.state} at {point.delta_k:g} MPa sqrt(m)"


def _rate_slips(ratios: Sequence[tuple[MeasuredPoint, float]]) -> list[str]:
    """Name ratios far from the others, and a unit that all of them speak for."""
    values = [ratio for _, ratio in ratios]
    far = outliers(values)
    near = np.delete(np.log(values), far)
    without = math.exp(float(np.mean(near)))
    notes = [
        f"{_place(ratios[place][0])}: measured over computed is {values[place]:.3g}, the others "
        f"give {without:.3g}; a run-out is marked by yes in a column {RUN_OUT}, else look at the "
        "number"
        for place in far
    ]
    unit = rate_unit(without)
    if unit is not None:
        notes.append(
            f"measured rates are {without:.3g} times the computed ones: were they written in {unit}?"
        )
    return notes


def _delta_k_slips(points: Iterable[MeasuredPoint], computed: dict[str, Curves]) -> list[str]:
    """Name a unit that puts the points of a state, all above its curve, onto it."""
    notes = []
    points = list(points)
    for state, curve in computed.items():
        own = [point.delta_k for point in points if point.state == state]
        unit = delta_k_unit(own, curve.delta_k)
        if unit is not None:
            notes.append(f"Delta-K of {state} fits the computed curve if it was written in {unit}")
    return notes


def _held(point: MeasuredPoint, computed: dict[str, Curves], factor: float) -> str:
    """Return what the calibrated curve says of a run-out."""
    place = f"{_place(point)}, below {point.da_dn:.3g} m/cycle"
    reason = _outside(point, computed)
    if reason:
        return f"{place}: not compared, {reason}"
    rate = factor * math.exp(np.mean(_interpolated(computed[point.state], point.delta_k)))
    verdict = "agrees" if rate <= point.da_dn else "contradicts it"
    return f"{place}: the calibrated curve gives {rate:.3g}, {verdict}"


def _outside(point: MeasuredPoint, computed: dict[str, Curves]) -> str:
    """Return why a point cannot be compared, empty if it can."""
    if point.state not in computed:
        close = get_close_matches(point.state, computed, 1, NEAR)
        hint = f", did you mean {close[0]!r}?" if close else ""
        return f"the state has no computed growth rate{hint}"
    delta_k = computed[point.state].delta_k
    if point.delta_k < delta_k[0] * (1 - 1e-9):
        return f"below the smallest computed, {delta_k[0]:g}"
    if point.delta_k > delta_k[-1] * (1 + 1e-9):
        return f"above the largest computed, {delta_k[-1]:g}"
    return ""


def _interpolated(curve: Curves, delta_k: float) -> FloatArray:
    """Return log da/dN of each mesh at one delta_k; shape (meshes,)."""
    at, logs = math.log(delta_k), np.log(curve.delta_k)
    return np.array([np.interp(at, logs, rates) for rates in curve.log_rate])


def _variance_of_mean(values: FloatArray) -> float:
    return float(np.var(values, ddof=1)) / len(values) if len(values) > 1 else math.nan


def _half_width(parts: Sequence[tuple[float, int]]) -> float:
    """Return half the confidence interval from independent variances and their freedoms."""
    total = sum(variance for variance, _ in parts)
    if not total > 0:
        return total
    freedom = total**2 / sum(variance**2 / degrees for variance, degrees in parts)
    return float(student.ppf((1 + CONFIDENCE) / 2, freedom)) * math.sqrt(total)
