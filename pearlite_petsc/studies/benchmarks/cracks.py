"""Cracks grown under some settings, and how far they are from those of a reference."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from time import process_time
from typing import TYPE_CHECKING

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.config import load_scene_text
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.scene import Scene, State

if TYPE_CHECKING:
    from pearlite_petsc.growth.prepared import Prepared

SAME_PATH = 0.95
"""Share of common broken interfaces from which two cracks are the same."""

SMALLEST_ERROR = 1e-8
"""Errors below are taken as this in geometric means."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Which cracks: every state at every mesh and load.

    Attributes:
        states: Names.
        meshes: Indices.
        delta_k: [MPa sqrt(m)].
        overrides: Settings that all have in common, "table.key=value" each.
        sharing: Loads that share the making of a mesh, if more than the plan's.
    """

    states: tuple[str, ...]
    meshes: tuple[int, ...]
    delta_k: tuple[float, ...]
    overrides: tuple[str, ...] = ()
    sharing: int = 1


@dataclass(frozen=True, slots=True, eq=False)
class Grown:
    """One crack.

    Attributes:
        outcome: What came of it, None after an error.
        error: Message of the error that ended it, else empty.
        named: Whether the program raised that error on purpose.
        seconds: Processor time, its part of the mesh included; the wall time on an idle core.
    """

    outcome: Outcome | None
    error: str
    named: bool
    seconds: float


Key = tuple[str, int, float]
Cracks = Mapping[Key, Grown]


def grow(plan: Plan, overrides: Sequence[str] = (), scene_text: str = "") -> dict[Key, Grown]:
    """Grow all cracks of a plan on one rank.

    Args:
        plan: The cracks.
        overrides: Settings on top of the plan's.
        scene_text: What they are on top of (TOML); the default scene if empty.

    Raises:
        SceneError: The settings are refused.
    """
    # Here, so that --help starts neither MPI nor PETSc.
    from pearlite_petsc.growth.prepared import prepare_growth

    scene = load_scene_text(scene_text, "bench", [*plan.overrides, *overrides])
    states = {state.name: state for state in scene.states}
    found: dict[Key, Grown] = {}
    for name in plan.states:
        for mesh in plan.meshes:
            started = process_time()
            try:
                prepared = prepare_growth(scene, states[name], mesh)
            except Exception as error:
                failed = _failure(error, process_time() - started)
                found |= {(name, mesh, value): failed for value in plan.delta_k}
                continue
            share = (process_time() - started) / max(len(plan.delta_k), plan.sharing)
            for value in plan.delta_k:
                found[name, mesh, value] = _grown(scene, states[name], value, prepared, share)
    return found


def _grown(scene: Scene, state: State, delta_k: float, prepared: "Prepared", share: float) -> Grown:
    from pearlite_petsc.studies.growing import grow_alone

    started = process_time()
    try:
        outcome = grow_alone(scene, state, 1000.0 * delta_k, prepared)
    except Exception as error:
        # A benchmark of limits: whatever happens is its result.
        return _failure(error, share + process_time() - started)
    return Grown(outcome, "", False, share + process_time() - started)


def _failure(error: Exception, seconds: float) -> Grown:
    named = isinstance(error, PearliteError)
    return Grown(None, f"{type(error).__name__}: {error}", named, seconds)


def common_share(one: Outcome, other: Outcome) -> float:
    """Return the share of common broken interfaces in all that either broke, 1 if none did."""
    first, second = _broken(one), _broken(other)
    return len(first & second) / len(first | second) if first | second else 1.0


def _broken(outcome: Outcome) -> set[tuple[int, ...]]:
    assert outcome.shape is not None
    return {*map(tuple, outcome.shape.broken_pairs.tolist())}


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """Cracks against those of a reference.

    Attributes:
        tasks: Cracks in both.
        same_path: Those with at least ``SAME_PATH`` common broken interfaces.
        common: Mean share of common broken interfaces.
        error: Geometric mean of |ratio of da/dN - 1| over the same paths, NaN without one.
        low, high: That mean divided and multiplied by the geometric standard error.
        bias: Geometric mean of the ratio - 1 over the same paths, NaN without one.
        mean_error: |ratio of the geometric means of da/dN - 1| over all that grew in both.
        mean_scatter: Geometric standard error of that ratio - 1.
        seconds: Processor time a crack.
        solves_per_break: Linear solves per broken interface.
        not_grown: Cracks that ended otherwise than grown.
    """

    tasks: int
    same_path: int
    common: float
    error: float
    low: float
    high: float
    bias: float
    mean_error: float
    mean_scatter: float
    seconds: float
    solves_per_break: float
    not_grown: int


def compare(cracks: Cracks, reference: Cracks) -> Comparison:
    """Compare cracks with those of a reference, task by task."""
    both = [(cracks[key].outcome, reference[key].outcome) for key in cracks if key in reference]
    pairs = [(one, other) for one, other in both if one is not None and other is not None]
    shares = np.array([common_share(one, other) for one, other in pairs])
    rated = np.array([_rated(one) and _rated(other) for one, other in pairs], dtype=bool)
    logs = np.array(
        [
            np.log(one.da_dn / other.da_dn)
            for (one, other), yes in zip(pairs, rated, strict=True)
            if yes
        ]
    )
    same = logs[shares[rated] >= SAME_PATH] if len(pairs) else logs
    error, low, high = geometric_mean(np.abs(np.expm1(same)))
    outcomes = [item.outcome for item in cracks.values() if item.outcome is not None]
    broken = sum(len(o.shape.broken_pairs) for o in outcomes if o.shape is not None)
    scatter = logs.std(ddof=1) / np.sqrt(len(logs)) if len(logs) > 1 else float("nan")
    return Comparison(
        tasks=len(both),
        same_path=int((shares >= SAME_PATH).sum()),
        common=float(shares.mean()) if len(shares) else float("nan"),
        error=error,
        low=low,
        high=high,
        bias=float(np.expm1(same.mean())) if len(same) else float("nan"),
        mean_error=float(abs(np.expm1(logs.mean()))) if len(logs) else float("nan"),
        mean_scatter=float(np.expm1(scatter)),
        seconds=sum(item.seconds for item in cracks.values()) / len(cracks),
        solves_per_break=sum(o.effort.solves for o in outcomes) / max(broken, 1),
        not_grown=len(cracks) - sum(o.stop_reason is StopReason.GROWN for o in outcomes),
    )


def geometric_mean(values: FloatArray) -> tuple[float, float, float]:
    """Return the geometric mean, and it divided and multiplied by its geometric standard error.

    NaN without values; the error is 1 for one value alone.
    """
    if not len(values):
        return float("nan"), float("nan"), float("nan")
    logs = np.log(np.maximum(values, SMALLEST_ERROR))
    scatter = logs.std(ddof=1) / np.sqrt(len(logs)) if len(logs) > 1 else 0.0
    mean, factor = float(np.exp(logs.mean())), float(np.exp(scatter))
    return mean, mean / factor, mean * factor


def _rated(outcome: Outcome) -> bool:
    return outcome.da_dn > 0.0
