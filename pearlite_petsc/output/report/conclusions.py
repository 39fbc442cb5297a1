"""The source's qualitative conclusions against what was computed, with numbers."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.output.figures.style import state_label
from pearlite_petsc.output.null_model import null_ratio
from pearlite_petsc.output.statistics import (
    Estimate,
    common_levels,
    counts,
    mean_difference,
    mean_with_interval,
    rate_ratio,
)
from pearlite_petsc.output.tables import delta_k_in_mpa_sqrt_m
from pearlite_petsc.scene import Scene, State

LITTLE = 1.5
"""Two rates within this factor differ little: less than the scatter from mesh to mesh."""

_LACKING = "The scene lacks one of the states."


class Verdict(str, Enum):
    """Whether the simulations bear a statement out."""

    YES = "borne out"
    TENDENCY = "in the mean, within scatter"
    DOUBT = "not in the mean, within scatter"
    NO = "not borne out"
    OPEN = "not decided here"


@dataclass(frozen=True, slots=True)
class Conclusion:
    """A statement of the source, the verdict, and the numbers behind it."""

    statement: str
    verdict: Verdict
    numbers: str


def conclusions(scene: Scene, outcomes: Sequence[Outcome]) -> list[Conclusion]:
    """Return the source's statements in its order; those without data are "not decided here".

    States compare at the delta_k at which every mesh of both grew, rates by geometric means, with
    the 95 % interval over meshes. A statement is borne out if the whole interval agrees with it, not borne out if the
    whole interval contradicts it; between the two the mean leans one way within the scatter.

    Args:
        scene: Gives the states.
        outcomes: Every task.
    """
    return [
        _faster_by_orientation(scene, outcomes),
        _hardening(scene),
        _lower_tortuosity(scene, outcomes),
        _moderate_like_severe(scene, outcomes),
        _slower_across(scene, outcomes),
    ]


def microstructure_factor(
    scene: Scene, outcomes: Sequence[Outcome], name: str, other: str, bounds: bool = False
) -> tuple[Estimate, float]:
    """Return the measured rate ratio of two states and the null model's at the same delta_k.

    Args:
        scene: Gives the states.
        outcomes: Every task.
        name, other: States.
        bounds: For the first state, take cracks that ran into the window's boundary as well.
    """
    states = {state.name: state for state in scene.states}
    levels = common_levels(outcomes, name, other, scene.loading.delta_k, bounds)
    measured = rate_ratio(outcomes, name, other, levels, bounds)
    if not levels or name not in states or other not in states:
        return measured, float("nan")
    null = null_ratio(np.array(levels), states[name], states[other])
    with np.errstate(divide="ignore", invalid="ignore"):
        return measured, float(np.exp(np.mean(np.log(null))))


def _faster_by_orientation(scene: Scene, outcomes: Sequence[Outcome]) -> Conclusion:
    statement = "Deformed pearlite (A-T) is faster than undeformed, because of its orientation."
    base, sheared = _undeformed(scene), _sheared(scene, "AT")
    if base is None or not sheared:
        return Conclusion(statement, Verdict.OPEN, _LACKING)
    found, texts = [], []
    for state in sheared:
        ratio, null = microstructure_factor(scene, outcomes, state.name, base.name)
        if not np.isfinite(ratio.value):
            texts.append(_no_data(state))
            found.append(Verdict.OPEN)
            continue
        texts.append(
            f"{state_label(state.name)}: {_times(ratio)} the undeformed rate "
            f"{_where(scene, outcomes, state, base)}; yield stress and threshold alone "
            f"would give {null:.2f} times, which leaves a factor of {ratio.value / null:.2f} to "
            "the microstructure"
        )
        part = Estimate(ratio.value / null, ratio.low / null, ratio.high / null)
        found += [_above(ratio, 1.0), _above(part, 1.0)]
    return Conclusion(statement, _worst(found), "; ".join(texts))


def _hardening(scene: Scene) -> Conclusion:
    statement = "Hardening slows growth slightly."
    base = _undeformed(scene)
    others = [s for s in scene.states if base is not None and s.yield_stress != base.yield_stress]
    if base is None or not others:
        return Conclusion(statement, Verdict.OPEN, "All states have the same yield stress.")
    factors = sorted({round(base.yield_stress / s.yield_stress, 3) for s in others})
    text = ", ".join(f"× {value:.2f}" for value in factors)
    return Conclusion(
        statement,
        Verdict.OPEN,
        f"This is an input: the damage law divides by the yield stress, which at equal threshold "
        f"and path gives {text} of the undeformed rate. To see the effect alone, run the states "
        "with the same threshold, and again with the same yield stress.",
    )


def _lower_tortuosity(scene: Scene, outcomes: Sequence[Outcome]) -> Conclusion:
    statement = "Cracks in severely deformed A-T are less tortuous than in undeformed pearlite."
    base, severe = _undeformed(scene), _most_sheared(scene, "AT")
    if base is None or severe is None:
        return Conclusion(statement, Verdict.OPEN, _LACKING)
    levels = common_levels(outcomes, severe.name, base.name, scene.loading.delta_k)
    if not levels:
        return Conclusion(statement, Verdict.OPEN, _no_data(severe))
    samples = [_tortuosities(outcomes, state.name, levels) for state in (severe, base)]
    difference = mean_difference(*samples)
    means = [mean_with_interval(sample) for sample in samples]
    negative = Estimate(-difference.value, -difference.high, -difference.low)
    return Conclusion(
        statement,
        _above(negative, 0.0),
        f"{state_label(severe.name)} {_interval(means[0])}, {state_label(base.name)} "
        f"{_interval(means[1])}; difference {_interval(difference)}, "
        f"{_where(scene, outcomes, severe, base)}",
    )


def _moderate_like_severe(scene: Scene, outcomes: Sequence[Outcome]) -> Conclusion:
    statement = "Moderately and severely deformed A-T differ little."
    sheared = _sheared(scene, "AT")
    if len(sheared) < 2:
        return Conclusion(statement, Verdict.OPEN, "The scene has fewer than two such states.")
    ratio = rate_ratio(outcomes, sheared[-1].name, sheared[0].name, scene.loading.delta_k)
    if not np.isfinite(ratio.value):
        return Conclusion(statement, Verdict.OPEN, _no_data(sheared[-1]))
    verdict = _within(ratio, LITTLE)
    return Conclusion(
        statement,
        verdict,
        f"{state_label(sheared[-1].name)} grows {_times(ratio)} as fast as "
        f"{state_label(sheared[0].name)} {_where(scene, outcomes, sheared[-1], sheared[0])} "
        f"(little: within a factor of {LITTLE:g})",
    )


def _slower_across(scene: Scene, outcomes: Sequence[Outcome]) -> Conclusion:
    statement = "Growth across the lamellae (T-A) is slower than in undeformed pearlite."
    base, sheared = _undeformed(scene), _sheared(scene, "TA")
    if base is None or not sheared:
        return Conclusion(statement, Verdict.OPEN, _LACKING)
    found, texts = [], []
    for state in sheared:
        ratio, null = microstructure_factor(scene, outcomes, state.name, base.name, bounds=True)
        if not np.isfinite(ratio.value):
            texts.append(_no_data(state))
            found.append(Verdict.OPEN)
            continue
        where = _where(scene, outcomes, state, base, bounds=True)
        text = (
            f"{state_label(state.name)}: {_times(ratio)} the undeformed rate {where} (yield stress "
            f"and threshold alone: {null:.2f} times)"
        )
        levels = common_levels(outcomes, state.name, base.name, scene.loading.delta_k, bounds=True)
        own = [o for o in outcomes if o.state == state.name and o.delta_k in levels]
        bounds = sum(not counts(o) for o in own)
        if bounds:
            text += (
                f", an upper bound: {bounds} of {len(own)} cracks turned along the lamellae and "
                "ran into the window's edge"
            )
        inverse = Estimate(1.0 / ratio.value, 1.0 / ratio.high, 1.0 / ratio.low)
        found.append(_above(inverse, 1.0))
        texts.append(text)
    return Conclusion(statement, _worst(found), "; ".join(texts))


def _undeformed(scene: Scene) -> State | None:
    return next((state for state in scene.states if state.shear_strain == 0.0), None)


def _sheared(scene: Scene, orientation: str) -> list[State]:
    own = [s for s in scene.states if s.shear_strain != 0.0 and s.orientation == orientation]
    return sorted(own, key=lambda state: abs(state.shear_strain))


def _most_sheared(scene: Scene, orientation: str) -> State | None:
    sheared = _sheared(scene, orientation)
    return sheared[-1] if sheared else None


def _tortuosities(outcomes: Sequence[Outcome], state: str, levels: Sequence[float]) -> list[float]:
    """Return one number a mesh: the mean over these delta_k."""
    chosen = [o for o in outcomes if o.state == state and o.delta_k in levels]
    own = [(o.mesh_index, o.tortuosity) for o in chosen]
    values = [(mesh, value) for mesh, value in own if value is not None]
    return [
        float(np.mean([value for mesh, value in values if mesh == index]))
        for index in sorted({mesh for mesh, _ in values})
    ]


def _above(estimate: Estimate, limit: float) -> Verdict:
    # One mesh has no scatter to compare with.
    if not np.isfinite(estimate.low):
        return Verdict.OPEN
    if estimate.low > limit:
        return Verdict.YES
    if estimate.high < limit:
        return Verdict.NO
    return Verdict.TENDENCY if estimate.value > limit else Verdict.DOUBT


def _within(ratio: Estimate, factor: float) -> Verdict:
    if not np.isfinite(ratio.low):
        return Verdict.OPEN
    if 1.0 / factor < ratio.low and ratio.high < factor:
        return Verdict.YES
    if ratio.low > factor or ratio.high < 1.0 / factor:
        return Verdict.NO
    return Verdict.TENDENCY if 1.0 / factor < ratio.value < factor else Verdict.DOUBT


def _worst(verdicts: Sequence[Verdict]) -> Verdict:
    if not verdicts or Verdict.OPEN in verdicts:
        return Verdict.OPEN
    order = (Verdict.NO, Verdict.DOUBT, Verdict.TENDENCY, Verdict.YES)
    return next(verdict for verdict in order if verdict in verdicts)


def _no_data(state: State) -> str:
    return f"{state_label(state.name)}: no ΔK at which every mesh of both states grew"


def _where(
    scene: Scene, outcomes: Sequence[Outcome], state: State, other: State, bounds: bool = False
) -> str:
    every = scene.loading.delta_k
    levels = common_levels(outcomes, state.name, other.name, every, bounds)
    shown = ", ".join(f"{delta_k_in_mpa_sqrt_m(level):g}" for level in levels)
    return f"at {len(levels)} of {len(every)} ΔK ({shown} MPa√m)"


def _times(ratio: Estimate) -> str:
    return f"{_interval(ratio)} times"


def _interval(estimate: Estimate) -> str:
    if not np.isfinite(estimate.value):
        return "no data"
    if not np.isfinite(estimate.low):
        return f"{estimate.value:.2f} (one mesh)"
    return f"{estimate.value:.2f} ({estimate.low:.2f} to {estimate.high:.2f})"
