"""One crack: what its growth must and must not depend on."""

import gc
import weakref
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.config import load_scene_text
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.growth.checkpoint import Checkpoint
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import Prepared, prepare_growth
from pearlite_petsc.scene import Kind, Scene, State
from pearlite_petsc.studies.benchmarks.cracks import SAME_PATH, common_share
from tests.scenes import STATES, default_scene

DELTA_K = 20e3


def small_scene(**changes: Any) -> Scene:
    parts: dict[str, Any] = {
        "window": {"width": 100.0, "height": 100.0, "notch": 40.0},
        "elements": {"radius": 18.0},
        "loading": {"extension": 20.0},
        "cycle_jump": {"method": "compliance", "delta_d": 1.0},
        "solver": {"relative_tolerance": 1e-9},
    }
    for name, fields in changes.items():
        parts[name] = parts.get(name, {}) | fields
    return default_scene(**parts)


@cache
def prepared_for(scene: Scene, state: State) -> Prepared:
    return prepare_growth(scene, state, 0)


def grow(
    scene: Scene,
    state: str = "undeformed",
    delta_k: float = DELTA_K,
    checkpoint: Checkpoint | None = None,
    **changes: float,
) -> Outcome:
    steel = replace(STATES[state], **changes)
    prepared = prepared_for(scene, steel)
    growth = CrackGrowth(MPI.COMM_SELF, scene, steel, delta_k, prepared, checkpoint)
    outcome = growth.grown()
    assert outcome is not None
    return outcome


@pytest.mark.parametrize("method", ["factors", "iterative", "direct"])
def test_a_crack_leaves_nothing_behind_for_the_garbage_collector(method: str) -> None:
    scene = small_scene(solver={"method": method}, loading={"extension": 8.0})
    steel = STATES["severe_AT"]
    growth = CrackGrowth(MPI.COMM_SELF, scene, steel, DELTA_K, prepared_for(scene, steel))
    gc.collect()
    gc.disable()
    try:
        outcome = growth.grown()
        assert outcome is not None and outcome.effort.refinements > 0
        domain, crack = weakref.ref(growth.domain), weakref.ref(growth)
        del growth
        assert domain() is None and crack() is None
    finally:
        gc.enable()


@pytest.mark.parametrize("state", ["undeformed", "severe_AT", "moderate_TA"])
def test_crack_goes_on_from_a_checkpoint_bit_for_bit(state: str) -> None:
    scene = small_scene()
    prepared = prepared_for(scene, STATES[state])
    growth = CrackGrowth(MPI.COMM_SELF, scene, STATES[state], DELTA_K, prepared)
    steps, checkpoints = [], []
    for step in growth.steps():
        steps.append(step)
        checkpoints.append(growth.checkpoint())
    assert steps[-1].stop is not None
    assert (steps[0].cycles, steps[0].solves) == (0.0, 1)
    whole = growth.outcome(steps[-1].stop)
    growth.close()
    assert whole is not None and whole.history is not None and whole.effort.refinements > 0
    for checkpoint in checkpoints[0 : -1 : max(len(checkpoints) // 4, 1)]:
        rest = grow(scene, state, checkpoint=checkpoint)
        assert rest.da_dn == whole.da_dn
        assert np.array_equal(rest.history, whole.history)
        assert rest.effort.counters == whole.effort.counters


def test_factors_made_anew_in_a_block_are_made_anew_after_a_checkpoint_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("pearlite_petsc.solver.equilibrium.setup_cost", lambda _: -1.0)
    scene = small_scene(
        elements={"refinement": "uniform", "width": 3.0, "length": 6.0},
        solver={"method": "factors", "relative_tolerance": 1e-9},
    )
    prepared = prepared_for(scene, STATES["undeformed"])
    growth = CrackGrowth(MPI.COMM_SELF, scene, STATES["undeformed"], DELTA_K, prepared)
    checkpoints = []
    for step in growth.steps():
        known = growth._body.coupling.compliance
        if step.stop is None and known is not None and known.is_outdated:
            checkpoints.append(growth.checkpoint())
    assert step.stop is not None and checkpoints
    whole = growth.outcome(step.stop)
    growth.close()
    assert whole is not None and whole.history is not None
    for checkpoint in checkpoints[:3]:
        rest = grow(scene, checkpoint=checkpoint)
        assert np.array_equal(rest.history, whole.history)
        assert rest.effort.counters == whole.effort.counters


@pytest.mark.parametrize("state", ["moderate_AT", "severe_AT", "moderate_TA"])
def test_crack_on_the_mesh_that_follows_it_is_that_of_the_uniform_mesh(state: str) -> None:
    follows = grow(small_scene(), state)
    uniform = grow(small_scene(elements={"refinement": "uniform"}), state)
    assert follows.effort.elements < 0.8 * uniform.effort.elements
    assert np.array_equal(follows.shape.broken_pairs, uniform.shape.broken_pairs)
    assert follows.cycles == pytest.approx(uniform.cycles, rel=0.03)


def one_colony(size: float, notch: float) -> Scene:
    """Return a window so small that a crack of 30 um comes to its edge."""
    return small_scene(
        window={"width": size, "height": size, "notch": notch},
        microstructure={"prior_austenite_grain": 1e4, "block": 1e4, "colony": 1e4},
        loading={"extension": 30.0},
    )


def test_load_whose_pull_changes_fast_near_the_window_edge_is_followed() -> None:
    scene = one_colony(60.0, 15.0)
    prepared, outcomes = prepare_growth(scene, STATES["severe_AT"], 4), []
    for step in (1.0, 0.2):
        jump = replace(scene.cycle_jump, delta_d=step)
        stepped = replace(scene, cycle_jump=jump)
        growth = CrackGrowth(MPI.COMM_SELF, stepped, STATES["severe_AT"], 12e3, prepared)
        outcomes.append(growth.grown())
    whole, fine = outcomes
    assert whole is not None and fine is not None
    assert np.array_equal(whole.shape.broken_pairs, fine.shape.broken_pairs)
    assert whole.cycles == pytest.approx(fine.cycles, rel=0.03)


def test_crack_that_ends_at_the_window_edge_has_grown_all_the_same() -> None:
    outcome = grow(one_colony(36.0, 3.0), "severe_AT", 12e3)
    assert outcome.stop_reason is StopReason.GROWN
    assert outcome.extension > 30.0


def test_direct_and_iterative_solver_grow_one_crack() -> None:
    iterative = grow(small_scene())
    direct = grow(small_scene(solver={"method": "direct"}))
    assert np.array_equal(iterative.shape.broken_pairs, direct.shape.broken_pairs)
    assert iterative.da_dn == pytest.approx(direct.da_dn, rel=1e-6)


def test_without_a_threshold_twice_the_load_grows_the_same_crack_eight_times_as_fast() -> None:
    scene = small_scene()
    once = grow(scene, delta_k=10e3, delta_k_th=0.0)
    twice = grow(scene, delta_k=20e3, delta_k_th=0.0)
    assert np.array_equal(once.shape.broken_pairs, twice.shape.broken_pairs)
    assert twice.da_dn / once.da_dn == pytest.approx(8.0, rel=1e-6)


@pytest.mark.parametrize("state", ["undeformed", "severe_AT", "moderate_TA"])
def test_one_block_a_break_is_as_good_as_fifty_of_another_method(state: str) -> None:
    # Exponential blocks know nothing of what couples the interfaces.
    exact = grow(small_scene(cycle_jump={"method": "exponential", "delta_d": 0.02}), state)
    once = grow(small_scene(), state)
    assert once.effort.solves < 1.5 * len(once.shape.broken_pairs)
    assert exact.effort.solves > 20 * once.effort.solves
    assert common_share(once, exact) >= SAME_PATH
    assert once.cycles == pytest.approx(exact.cycles, rel=0.04)


@pytest.mark.parametrize(
    ("method", "delta_d", "tolerance", "error"),
    [
        ("euler", 0.05, 0.1, 0.12),
        ("exponential", 0.2, 0.1, 0.12),
        ("heun", 0.1, 0.1, 0.08),
        ("adaptive", 0.5, 0.01, 0.04),
    ],
)
def test_every_cycle_jump_comes_to_one_life(
    method: str, delta_d: float, tolerance: float, error: float
) -> None:
    settings = {"method": method, "delta_d": delta_d, "tolerance": tolerance}
    exact = grow(small_scene(cycle_jump={"method": "compliance", "delta_d": 0.02}), "severe_AT")
    found = grow(small_scene(cycle_jump=settings), "severe_AT")
    assert found.cycles == pytest.approx(exact.cycles, rel=error)


def test_load_below_the_threshold_arrests_at_once() -> None:
    outcome = grow(small_scene(), delta_k=2e3)
    assert outcome.stop_reason is StopReason.ARRESTED
    assert outcome.effort.solves == 1
    assert outcome.cycles == outcome.extension == 0.0
    assert np.isnan(outcome.da_dn) and outcome.tortuosity is None


def test_crack_that_grew_and_stands_still_has_no_growth_rate() -> None:
    outcome = grow(small_scene(), delta_k=7e3)
    assert outcome.stop_reason is StopReason.ARRESTED
    assert outcome.extension > 0.0 and outcome.cycles > 0.0
    assert np.isnan(outcome.da_dn)


def test_task_stops_at_its_limit_of_solves() -> None:
    outcome = grow(small_scene(solver={"max_solves": 5}))
    assert outcome.stop_reason is StopReason.MAX_SOLVES
    # A block goes on until its end is borne out.
    assert outcome.effort.solves in (5, 6)


def test_crack_that_leaves_a_corridor_says_so() -> None:
    elements = {"refinement": "corridor", "corridor": 12.0}
    outcome = grow(small_scene(elements=elements), "severe_TA")
    assert outcome.stop_reason is StopReason.LEFT_REFINED_ZONE


def test_edge_crack_grows_faster_under_constant_stress_than_under_constant_k() -> None:
    loads = {"kind": "edge_crack", "extension": 20.0}
    stress, constant = (
        grow(
            small_scene(elements={"kinds": "labels"}, loading=loads | {"control": control}),
            "severe_AT",
        )
        for control in ("stress", "K")
    )
    assert stress.da_dn > 1.3 * constant.da_dn


@pytest.mark.parametrize("springs", ["raje", "matched"])
def test_other_springs_grow_a_crack(springs: str) -> None:
    material = {"springs": springs, "poisson_ratio": 0.2}
    outcome = grow(small_scene(material=material), "severe_AT")
    assert outcome.stop_reason is StopReason.GROWN


def test_nominal_stress_lives_longer_than_effective() -> None:
    nominal = {"stress": "nominal", "failure_damage": 0.9}
    jump = {"method": "compliance", "delta_d": 0.2}
    slow = grow(small_scene(damage=nominal, cycle_jump=jump), "severe_AT")
    fast = grow(small_scene(cycle_jump=jump), "severe_AT")
    assert slow.da_dn < fast.da_dn


def test_broken_interfaces_carry_nothing_and_states_are_consistent() -> None:
    scene = small_scene()
    prepared = prepared_for(scene, STATES["severe_AT"])
    growth = CrackGrowth(MPI.COMM_SELF, scene, STATES["severe_AT"], DELTA_K, prepared)
    before = 0.0
    for step in growth.steps():
        state = growth.growth_state()
        assert state is not None
        broken = state.damage >= 1.0
        assert not state.normal_stress[broken].any() and not state.shear_stress[broken].any()
        assert np.all(broken[state.mesh.kind == Kind.NOTCH])
        assert np.array_equal(broken, ~np.isnan(state.failure_cycles))
        assert state.crack.length == step.crack_length >= before
        before = step.crack_length
        steps = np.hypot(*np.diff(state.crack.path, axis=0).T)
        assert state.crack.path_length == pytest.approx(steps.sum(), abs=1e-9)
    growth.close()


@pytest.mark.slow
@pytest.mark.parametrize("springs", ["homogeneous", "raje"])
@pytest.mark.parametrize("state", STATES)
def test_no_crack_of_the_quickstart_is_left_to_the_solver(state: str, springs: str) -> None:
    scene = load_scene_text("", "test", [f"material.springs={springs}"])
    assert scene.ensemble.meshes == 4 and scene.loading.extension == 60.0
    direct = replace(scene, solver=replace(scene.solver, method="direct"))
    for index in range(scene.ensemble.meshes):
        prepared = prepare_growth(scene, STATES[state], index)
        found, exact = (
            CrackGrowth(MPI.COMM_SELF, each, STATES[state], 18e3, prepared).grown()
            for each in (scene, direct)
        )
        assert found is not None and exact is not None
        assert np.array_equal(found.shape.broken_pairs, exact.shape.broken_pairs)
        assert found.cycles == pytest.approx(exact.cycles, rel=1e-6)
        assert found.effort.counters["iterations"] < 40 * found.effort.counters["solves"]
        assert not {"refreshed", "direct"} & set(found.effort.counters)
