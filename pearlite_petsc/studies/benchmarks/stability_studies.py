"""What is varied until it fails: each study a row of points, each with what happened there."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial

import numpy as np

from pearlite_petsc.config import load_scene_text
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.output.figures.charts import OUTCOMES
from pearlite_petsc.studies.benchmarks.cracks import Cracks, Plan, grow

CONVERGES, FALLS_BACK, STOPS, WRONG = OUTCOMES
FALLBACKS = ("multigrid", "refreshed", "direct")
MOST_ERROR = 0.1
"""Error of da/dN, of a modulus or of K^3 from which a result counts as wrong."""


@dataclass(frozen=True, slots=True)
class Point:
    """What happened at one value of a study.

    Attributes:
        study, value: What was varied, and to what.
        outcome: One of ``OUTCOMES``.
        remark: Short, for the figure.
        error: Against the reference, NaN without a result.
        reason: Stop reason or message.
    """

    study: str
    value: str
    outcome: str
    remark: str
    error: float
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Effort:
    """Cracks of the studies, and whether every value is taken or first, middle and last ones."""

    plan: Plan
    quick: bool

    def chosen(self, values: Sequence[float]) -> Sequence[float]:
        """Return the values to take."""
        return (values[0], values[len(values) // 2], values[-1]) if self.quick else values


def judged(study: str, value: str, cracks: Cracks, reference: Cracks) -> Point:
    """Return what happened to some cracks, against their reference."""
    crashed = [item.error for item in cracks.values() if item.error and not item.named]
    if crashed:
        return Point(study, value, WRONG, "crash", float("nan"), crashed[0])
    refused = [item.error for item in cracks.values() if item.error]
    if refused:
        return Point(study, value, STOPS, "error", float("nan"), refused[0])
    logs, reasons, fallbacks = [], [], 0.0
    for key, item in cracks.items():
        mine, other = item.outcome, reference[key].outcome
        assert mine is not None
        if other is None or mine.stop_reason is not other.stop_reason:
            reasons.append(mine.stop_reason.value)
        elif mine.da_dn > 0.0 and other.da_dn > 0.0:
            logs.append(np.log(mine.da_dn / other.da_dn))
        else:
            reasons.append(mine.stop_reason.value)
        fallbacks += sum(mine.effort.counters.get(name, 0.0) for name in FALLBACKS)
    error = float(np.expm1(np.mean(logs))) if logs else float("nan")
    if reasons:
        return Point(study, value, STOPS, reasons[0], error, ", ".join(sorted(set(reasons))))
    if abs(error) > MOST_ERROR:
        return Point(study, value, WRONG, f"{error:+.0%}", error)
    if fallbacks:
        return Point(study, value, FALLS_BACK, f"{fallbacks:.0f} times", error)
    return Point(study, value, CONVERGES, f"{error:+.1%}", error)


def crack_point(
    study: str, value: float, plan: Plan, reference: Cracks, overrides: Sequence[str]
) -> Point:
    """Grow the cracks of one point and judge them."""
    try:
        cracks = grow(plan, overrides)
    except SceneError as error:
        return Point(study, f"{value:.3g}", STOPS, "refused", float("nan"), str(error))
    return judged(study, f"{value:.3g}", cracks, reference)


def measured(study: str, value: float, measure: Callable[[], float]) -> Point:
    """Return a point from one number that should be 1."""
    text = f"{value:.4g}"
    try:
        error = measure() - 1.0
    except PearliteError as refused:
        return Point(study, text, STOPS, "refused", float("nan"), str(refused))
    wrong = not abs(error) <= MOST_ERROR
    return Point(study, text, WRONG if wrong else CONVERGES, f"{error:+.2g}", error)


def damage_steps(effort: Effort) -> Iterator[Point]:
    """Vary the largest increment of a block, for the default jump and the source's."""
    reference = grow(effort.plan, ("cycle_jump.delta_d=0.02",))
    for method in ("compliance", "euler"):
        for value in effort.chosen((0.01, 0.03, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)):
            if value < 0.03 and effort.quick:
                continue
            overrides = (f"cycle_jump.method={method}", f"cycle_jump.delta_d={value}")
            yield crack_point(f"delta_d, {method}", value, effort.plan, reference, overrides)


def tolerances(effort: Effort) -> Iterator[Point]:
    """Vary the solver's tolerance."""
    reference = grow(effort.plan, ("solver.method=direct",))
    for value in effort.chosen((1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 1e-12)):
        overrides = (f"solver.relative_tolerance={value}",)
        yield crack_point("solver tolerance", value, effort.plan, reference, overrides)


def loads(effort: Effort) -> Iterator[Point]:
    """Vary Delta-K over the threshold; the reference takes small blocks and a direct solver."""
    states = {state.name: state for state in load_scene_text("", "bench").states}
    name = effort.plan.states[0]
    threshold = states[name].delta_k_th / 1000.0
    for value in effort.chosen((0.9, 1.0, 1.1, 1.5, 3.0, 10.0, 100.0)):
        # More digits than the threshold's, so that 1.0 is not above it by rounding.
        plan = Plan((name,), effort.plan.meshes, (value * threshold,), effort.plan.overrides)
        reference = grow(plan, ("solver.method=direct", "cycle_jump.delta_d=0.1"))
        point = crack_point("Delta-K over threshold", value, plan, reference, ())
        yield point


def windows(effort: Effort) -> Iterator[Point]:
    """Vary the window over the extension for a straight crack in one colony; 6 is the reference."""
    extension = 15.0 if effort.quick else 30.0
    # The lattice lies otherwise in every window, which alone changes a crack by some 15 %.
    meshes = (0,) if effort.quick else tuple(range(40))
    alone = tuple(
        f"microstructure.{level}_um=1e4" for level in ("prior_austenite_grain", "block", "colony")
    )

    def cracks(value: float) -> Cracks:
        size = value * extension
        notch = min(40.0, 0.5 * (size - extension))
        window = (f"window.{key}_um={size}" for key in ("width", "height"))
        plan = Plan(("severe_AT",), meshes, (12.0,), alone)
        return grow(
            plan, (*window, f"window.notch_um={notch}", f"loading.extension_um={extension}")
        )

    reference = cracks(6.0)
    for value in effort.chosen((1.2, 1.5, 2.0, 3.0, 4.0, 6.0)):
        study = "window over extension"
        try:
            yield judged(study, f"{value:.3g}", cracks(value), reference)
        except SceneError as error:
            yield Point(study, f"{value:.3g}", STOPS, "refused", float("nan"), str(error))


def element_widths(effort: Effort) -> Iterator[Point]:
    """Vary the element width against a colony of 15 um; the reference is the finest."""
    meshes = (0,) if effort.quick else (0, 1)
    plan = Plan(effort.plan.states, meshes, effort.plan.delta_k, effort.plan.overrides)

    def overrides(value: float) -> tuple[str, ...]:
        radius = max(18.0, 4.0 * value)
        return (
            f"elements.width_um={value}",
            f"elements.length_um={2 * value}",
            f"elements.radius_um={radius}",
        )

    reference = grow(plan, overrides(1.5))
    for value in effort.chosen((1.5, 2.0, 3.0, 5.0, 10.0, 16.0)):
        point = crack_point("element width [um]", value, plan, reference, overrides(value))
        yield point


def poisson_ratios(effort: Effort) -> Iterator[Point]:
    """Vary nu: da/dN with ``raje`` and ``matched`` against ``homogeneous`` springs."""
    reference = grow(effort.plan)
    for springs in ("raje", "matched"):
        for value in effort.chosen((0.0, 0.1, 0.2, 0.3, 0.33, 0.334, 0.4)):
            overrides = (f"material.springs={springs}", f"material.poisson_ratio={value}")
            yield crack_point(f"nu, {springs}", value, effort.plan, reference, overrides)


def shears(effort: Effort) -> Iterator[Point]:
    """Vary gamma: the worse of E_x and E_y over E, homogeneous springs, undamaged mesh."""
    for shear in ("remesh", "affine"):
        for value in effort.chosen((0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 100.0)):
            yield measured(f"gamma, {shear}", value, partial(_modulus, shear, value))


def _modulus(shear: str, gamma: float) -> float:
    from pearlite_petsc.mechanics.elasticity import certificate
    from pearlite_petsc.mechanics.springs import spring_stiffness
    from pearlite_petsc.tessellation.build import build_mesh

    window = [f"window.{key}_um=80" for key in ("width", "height")]
    small = [*window, "window.notch_um=30", "loading.extension_um=20"]
    chosen = [f"elements.shear={shear}", f"states.severe_AT.shear_strain={gamma}"]
    refinement = "elements.refinement=uniform"
    scene = load_scene_text("", "bench", [*small, *chosen, refinement])
    state = next(state for state in scene.states if state.name == "severe_AT")
    mesh = build_mesh(scene, state, 0)
    found = certificate(mesh, spring_stiffness(mesh, scene.material))
    ratios = np.array([found.e_x, found.e_y]) / scene.material.youngs_modulus
    return float(ratios[np.argmax(np.abs(np.log(ratios)))])


def residual_stiffnesses(effort: Effort) -> Iterator[Point]:
    """Leave broken interfaces a share of their stiffness: K^3 of an edge crack over that with none."""
    clean = _release(0.0)
    for value in effort.chosen((1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0.0)):

        def cubed(value: float = value) -> float:
            return float((_release(value) / clean) ** 1.5)

        yield measured("residual stiffness (emulated)", value, cubed)


def _release(share: float) -> float:
    """Return the energy that an advance of an edge crack releases [uN um]."""
    from pearlite_petsc.mechanics.loads import uniform_stress
    from pearlite_petsc.mechanics.springs import Stiffness, spring_stiffness
    from pearlite_petsc.mechanics.statics import solve
    from pearlite_petsc.studies.bodies import on_line
    from pearlite_petsc.studies.cases import STEEL
    from pearlite_petsc.studies.cracked_bodies import EDGE, HALF_HEIGHT, grid_mesh

    body = EDGE[1]
    mesh = grid_mesh(body.width, 4.0)
    intact, none = spring_stiffness(mesh, STEEL), np.zeros(mesh.interface_count, dtype=np.bool_)
    energy = []
    for length in (body.before, body.after):
        left = np.where(on_line(mesh, HALF_HEIGHT, *body.ends(length)), share, 1.0)
        springs = Stiffness(intact.k_n * left, intact.k_t * left)
        energy.append(solve(mesh, springs, none, uniform_stress(0.0, 1.0, 0.0)).energy)
    return energy[1] - energy[0]


def facets(effort: Effort) -> Iterator[Point]:
    """Vary the shortest facet that is an interface, in shares of an element's size."""
    reference = grow(effort.plan)
    for value in effort.chosen((1e-6, 1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.2)):
        with dropping(value):
            yield crack_point("shortest facet", value, effort.plan, reference, ())


@contextmanager
def dropping(share: float) -> Iterator[None]:
    """Let the tessellation drop facets below another share of an element's size."""
    from pearlite_petsc.tessellation import assemble

    kept = assemble.DROPPING
    # No key of a scene: only this study asks for another value.
    assemble.DROPPING = share
    try:
        yield
    finally:
        assemble.DROPPING = kept


STUDIES: tuple[Callable[[Effort], Iterator[Point]], ...] = (
    poisson_ratios,
    shears,
    residual_stiffnesses,
    facets,
    damage_steps,
    tolerances,
    loads,
    windows,
    element_widths,
)
