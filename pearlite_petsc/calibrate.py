"""Command: the damage constant C that makes a finished result agree with measured growth rates.

The damage rate is proportional to C (Eq. (28)-(31)), so C scales the cycles of a crack and
nothing else: its path and all stresses stay, da/dN is proportional to C. The C that fits best in
the logarithm is the old one times the geometric mean of measured over computed rates; no new
simulation is needed.
"""

import argparse
import math
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.stats import t as student

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.config import load_scene, scene_to_toml
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.experiment import COLUMNS, MeasuredPoint, read_experiment
from pearlite_petsc.output.statistics import counts
from pearlite_petsc.output.tables import UM_PER_M, delta_k_in_mpa_sqrt_m, read_fcg
from pearlite_petsc.scene import Scene

CONFIDENCE = 0.95


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
    """

    factor: float
    error_points: float
    error_meshes: float
    interval: tuple[float, float]
    ratios: tuple[tuple[MeasuredPoint, float], ...]
    left_out: tuple[str, ...]
    ungrown: tuple[str, ...]

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

    Raises:
        SceneError: If no measured point lies on a computed curve.
    """
    computed, ungrown = curves(outcomes)
    used: list[tuple[MeasuredPoint, FloatArray]] = []
    left_out = []
    for point in points:
        reason = _outside(point, computed)
        if reason:
            left_out.append(f"{point.state} at {point.delta_k:g} MPa sqrt(m): {reason}")
        else:
            rates = _interpolated(computed[point.state], point.delta_k)
            used.append((point, math.log(point.da_dn) - rates))
    if not used:
        reasons = "; ".join([*left_out[:3], *ungrown[:3]]) or "there are none"
        raise SceneError(f"no measured point lies on a computed curve: {reasons}")
    logs = np.array([np.mean(ratio) for _, ratio in used])
    # Sums, not means, of a state's points: a state counts with the points that it has.
    of_meshes: dict[str, FloatArray] = {}
    for point, ratio in used:
        of_meshes[point.state] = of_meshes.get(point.state, 0.0) + ratio / len(used)
    parts = [(_variance_of_mean(logs), len(logs) - 1)]
    parts += [(_variance_of_mean(ratio), len(ratio) - 1) for ratio in of_meshes.values()]
    log_factor = float(np.mean(logs))
    half = _half_width(parts)
    return Calibration(
        factor=math.exp(log_factor),
        error_points=math.sqrt(parts[0][0]),
        error_meshes=math.sqrt(sum(variance for variance, _ in parts[1:])),
        interval=(math.exp(log_factor - half), math.exp(log_factor + half)),
        ratios=tuple((point, math.exp(np.mean(ratio))) for point, ratio in used),
        left_out=tuple(left_out),
        ungrown=ungrown,
    )


def report(scene: Scene, result: Calibration) -> str:
    """Return what the command prints: ratios, points left out, C, its error, the scene's line."""
    lines = ["measured over computed da/dN (geometric mean over meshes):"]
    for point, ratio in result.ratios:
        where = f"{point.state:<16} {point.delta_k:>8g} MPa sqrt(m)"
        lines.append(f"  {where}  {point.da_dn:.3e} m/cycle  {ratio:8.3g}")
    lines += [f"point left out: {text}" for text in result.left_out]
    lines += [f"computed, left out: {text}" for text in result.ungrown]
    low, high = result.interval
    lines += [
        f"points used: {len(result.ratios)} of {len(result.ratios) + len(result.left_out)}",
        f"load ratio of the scene: {scene.loading.load_ratio:g}; the points' must be the same",
        f"factor on C: {result.factor:.4g}",
        f"standard error of ln(factor): {_known(result.error)} "
        f"(points {_known(result.error_points)}, meshes {_known(result.error_meshes)})",
        f"{CONFIDENCE:.0%} confidence interval of the factor: {_known(low)} to {_known(high)}",
        f"old: {_scene_line(scene, scene.damage.c)}",
        "new, for the scene:",
        "[damage]",
        _scene_line(scene, float(f"{scene.damage.c * result.factor:.6g}")),
    ]
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return 0, or 2 for input that cannot be used."""
    parser = argparse.ArgumentParser(
        prog="python -m pearlite_petsc.calibrate",
        description="Damage constant C [um^5/N^2] from a finished result and measured growth rates",
        epilog="example: python -m pearlite_petsc.calibrate runs/paper --experiment rail.csv",
    )
    parser.add_argument("result", type=Path, help="output folder with fcg.csv")
    parser.add_argument(
        "--experiment",
        type=Path,
        required=True,
        metavar="FILE.csv",
        help=f"measured points, columns {', '.join(COLUMNS)}",
    )
    parser.add_argument("--state", metavar="NAME", help="use the points of this state only")
    options = parser.parse_args(arguments)
    try:
        scene = load_scene(options.result / "scene.resolved.toml")
        outcomes = read_fcg(options.result / "fcg.csv")
        points = read_experiment(options.experiment)
        if options.state is not None:
            points = _of_state(options.state, points, scene)
        sys.stdout.write(report(scene, calibrate(outcomes, points)))
    except PearliteError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    return 0


def _of_state(state: str, points: Iterable[MeasuredPoint], scene: Scene) -> list[MeasuredPoint]:
    known = [one.name for one in scene.states]
    if state not in known:
        raise SceneError(f"--state {state}: no state of the scene, known are {', '.join(known)}")
    return [point for point in points if point.state == state]


def _outside(point: MeasuredPoint, computed: dict[str, Curves]) -> str:
    """Return why a point cannot be compared, empty if it can."""
    if point.state not in computed:
        return "the state has no computed growth rate"
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


def _scene_line(scene: Scene, c: float) -> str:
    changed = replace(scene, damage=replace(scene.damage, c=c))
    lines = scene_to_toml(changed).splitlines()
    return next(line for line in lines if line.startswith("c_um5_per_n2"))


def _known(value: float) -> str:
    return "unknown (one only)" if math.isnan(value) else f"{value:.3g}"


if __name__ == "__main__":
    sys.exit(main())
