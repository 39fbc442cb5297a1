"""Where the model's assumptions end: plastic zone, remote stress, cracks that did not grow through.

Inside the reversed plastic zone the elastic stress is the model's driving force, not a stress that
the steel carries.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.mechanics.lefm import remote_stress, reversed_plastic_zone
from pearlite_petsc.output.doubts import doubts
from pearlite_petsc.output.tables import delta_k_in_mpa_sqrt_m, task_name
from pearlite_petsc.scene import Elements, Scene, State


@dataclass(frozen=True, slots=True)
class ZoneRow:
    """One state at one delta_k.

    Attributes:
        state: Name.
        delta_k: [MPa sqrt(m)].
        plastic_zone: Reversed plastic zone (Delta-K/(2 sigma_yield))^2/pi [um].
        colonies: The zone in colony diameters.
        window_share: The zone over the smaller side of the window.
        stress: Largest nominal stress of the load cycle [MPa]: the remote stress of an edge crack,
            or the K field's normal stress at the window's edge ahead of the notch.
        stress_share: That over the yield stress.
    """

    state: str
    delta_k: float
    plastic_zone: float
    colonies: float
    window_share: float
    stress: float
    stress_share: float


def zone_rows(scene: Scene) -> list[ZoneRow]:
    """Return the validity figures of every state at every delta_k of the scene."""
    return [_row(scene, state, value) for state in scene.states for value in scene.loading.delta_k]


def _row(scene: Scene, state: State, delta_k: float) -> ZoneRow:
    window, loading = scene.window, scene.loading
    zone = reversed_plastic_zone(delta_k, state.yield_stress)
    largest = delta_k / (1.0 - loading.load_ratio)
    if loading.kind == "edge_crack":
        stress = remote_stress(largest, window.notch, window.width)
    else:
        stress = largest / math.sqrt(2.0 * math.pi * (window.width - window.notch))
    return ZoneRow(
        state=state.name,
        delta_k=delta_k_in_mpa_sqrt_m(delta_k),
        plastic_zone=zone,
        colonies=zone / scene.microstructure.colony,
        window_share=zone / min(window.width, window.height),
        stress=stress,
        stress_share=stress / state.yield_stress,
    )


def validity_warnings(scene: Scene) -> list[str]:
    """Return one sentence for each assumption that the scene violates, with the numbers."""
    rows = zone_rows(scene)
    warnings = []
    over_colony = [row for row in rows if row.colonies > 1.0]
    if over_colony:
        worst = max(over_colony, key=lambda row: row.plastic_zone)
        warnings.append(
            f"The reversed plastic zone is larger than a colony in {len(over_colony)} of {len(rows)} "
            f"combinations, at most {worst.plastic_zone:.0f} µm ({worst.colonies:.1f} colonies; "
            f"{worst.state}, ΔK = {worst.delta_k:g} MPa√m): within it the elastic stress is the "
            "model's driving force, not a stress that the steel can carry."
        )
    over_window = [row for row in rows if row.window_share > 0.5]
    if over_window:
        worst = max(over_window, key=lambda row: row.window_share)
        warnings.append(
            f"The reversed plastic zone exceeds half the window in {len(over_window)} combinations, "
            f"at most {100.0 * worst.window_share:.0f} % of it ({worst.state}, "
            f"ΔK = {worst.delta_k:g} MPa√m): small-scale yielding does not hold there."
        )
    over_yield = [row for row in rows if row.stress_share > 1.0]
    if over_yield:
        worst = max(over_yield, key=lambda row: row.stress_share)
        lowest = min(row.delta_k for row in over_yield)
        what = (
            "remote stress"
            if scene.loading.kind == "edge_crack"
            else "normal stress at the window's edge ahead of the notch"
        )
        warnings.append(
            f"The {what} exceeds the yield stress from ΔK = {lowest:g} MPa√m on: it reaches "
            f"{worst.stress:.0f} MPa against {worst.stress / worst.stress_share:.0f} MPa "
            f"({worst.state}, ΔK = {worst.delta_k:g} MPa√m)."
        )
    return warnings


_REASONS = {
    StopReason.ARRESTED: "arrested (no interface above its threshold); no growth rate",
    StopReason.LEFT_REFINED_ZONE: "left the finely resolved zone; rate not used",
    StopReason.BOUNDARY: "reached the window's edge before the wanted extension; its rate is a bound",
    StopReason.MAX_SOLVES: "reached the limit of solves; rate not used",
    StopReason.FAILED: "failed",
}
_FALLBACKS = {
    "direct": "solves by the direct solver after the iterative one gave up",
    "loose_elements": "elements cut off by the crack at the end (held by the grounding)",
}


def task_warnings(outcomes: Sequence[Outcome], elements: Elements) -> dict[str, list[str]]:
    """Return the tasks that did not go as wanted, by reason: ends, doubts, fallbacks.

    Args:
        outcomes: The tasks.
        elements: Their size [um].
    """
    found: dict[str, list[str]] = {}
    for o in outcomes:
        name = task_name(o.state, o.mesh_index, o.delta_k)
        if o.stop_reason in _REASONS:
            text = f"{name}: {o.message.splitlines()[0]}" if o.message else name
            found.setdefault(_REASONS[o.stop_reason], []).append(text)
        for doubt in doubts(o, elements):
            found.setdefault(doubt, []).append(f"{name} ({o.cycles:.3g} cycles)")
        for counter, meaning in _FALLBACKS.items():
            count = o.effort.counters.get(counter, 0.0)
            if count > 0.0:
                found.setdefault(meaning, []).append(f"{name} ({count:g})")
    return found
