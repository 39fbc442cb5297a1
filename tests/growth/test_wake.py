"""The crack far behind its tip: large elements there change neither the crack nor its results."""

from functools import cache

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.fatigue.crack import CrackTracker
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.growth.checkpoint import Checkpoint
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import Prepared, prepare_growth
from pearlite_petsc.growth.wake import crack_wake
from pearlite_petsc.scene import Scene
from tests.scenes import STATES, default_scene

DELTA_K = 18e3


@cache
def scene_with(wake: str) -> Scene:
    return default_scene(
        window={"width": 240.0, "height": 200.0, "notch": 60.0},
        elements={"radius": 12.0, "wake": wake},
        loading={"extension": 100.0},
        cycle_jump={"method": "compliance", "delta_d": 1.0},
        solver={"method": "factors", "relative_tolerance": 1e-9},
    )


@cache
def prepared_for(state: str) -> Prepared:
    return prepare_growth(scene_with("fine"), STATES[state], 0)


def growth_of(state: str, wake: str, checkpoint: Checkpoint | None = None) -> CrackGrowth:
    prepared = prepared_for(state)
    scene = scene_with(wake)
    return CrackGrowth(MPI.COMM_SELF, scene, STATES[state], DELTA_K, prepared, checkpoint)


@cache
def grown(state: str, wake: str) -> Outcome:
    outcome = growth_of(state, wake).grown()
    assert outcome is not None
    return outcome


@pytest.mark.parametrize("state", ["undeformed", "severe_AT"])
def test_a_coarse_wake_changes_nothing_but_the_price(state: str) -> None:
    fine, coarse = grown(state, "fine"), grown(state, "coarse")
    assert fine.extension > 100.0
    assert coarse.effort.elements < 0.75 * fine.effort.elements
    assert np.array_equal(coarse.shape.broken_pairs, fine.shape.broken_pairs)
    assert coarse.da_dn == pytest.approx(fine.da_dn, rel=0.01)
    assert coarse.tortuosity == pytest.approx(fine.tortuosity, rel=1e-6)
    assert coarse.shape is not None and fine.shape is not None
    assert coarse.shape.path.shape == fine.shape.path.shape
    assert np.abs(coarse.shape.path - fine.shape.path).max() < 0.01
    assert coarse.history is not None and fine.history is not None
    assert np.allclose(coarse.history[:, 1:4], fine.history[:, 1:4], rtol=1e-6)
    # K_I and K_II at the tip over Delta-K, and the misfit of their measurement.
    k_coarse, k_fine = coarse.history[:, 4:], fine.history[:, 4:]
    assert np.nanmin(k_fine[:, 0]) > 0.5 and len(k_fine) > 25
    assert np.array_equal(np.isnan(k_coarse), np.isnan(k_fine))
    assert np.nanmax(np.abs(k_coarse - k_fine)[:, :2]) < 0.005


def test_crack_with_a_coarse_wake_goes_on_from_a_checkpoint_bit_for_bit() -> None:
    growth = growth_of("undeformed", "coarse")
    saved = [(step.stop, growth.checkpoint()) for step in growth.steps()]
    stop, _ = saved[-1]
    assert stop is not None
    whole = growth.outcome(stop)
    growth.close()
    assert whole is not None
    with_runs = [
        checkpoint
        for _, checkpoint in saved[:-1]
        if checkpoint and checkpoint.refinement.wake and checkpoint.refinement.wake.runs
    ]
    assert len(with_runs) > 10
    for checkpoint in with_runs[:: len(with_runs) // 3]:
        rest = growth_of("undeformed", "coarse", checkpoint).grown()
        assert rest is not None
        assert rest.da_dn == whole.da_dn
        assert np.array_equal(rest.history, whole.history)
        assert np.array_equal(rest.shape.path, whole.shape.path)
        assert np.array_equal(rest.shape.broken_pairs, whole.shape.broken_pairs)
        assert rest.effort.counters == whole.effort.counters


def straight_tracker(broken: int, gap: int | None = None) -> CrackTracker:
    """Return a crack of facets of 2 um along x from (0, 0); an element bridges one that is whole."""
    tracker = CrackTracker((0.0, 0.0), 0)
    for number in range(broken):
        if number == gap:
            continue
        # Those on both sides of the gap have the element at the gap in common.
        beside = gap is not None and abs(number - gap) == 1
        pairs = np.array([[9999 if beside else 2 * number, 2 * number + 1]])
        ends = np.array([[[2.0 * number, 0.0], [2.0 * number + 2.0, 0.0]]])
        tracker.add(pairs, np.array([[number, number + 1]]), ends)
    return tracker


ELEMENTS = scene_with("coarse").elements


def test_wake_is_the_crack_between_notch_and_the_tips_surroundings() -> None:
    wake = crack_wake(straight_tracker(50), (0.0, 0.0), ELEMENTS)
    (run,) = wake.runs
    assert run[0].tolist() == [6.0, 0.0] and run[-1].tolist() == [76.0, 0.0]
    assert len(run) == 36
    assert wake.stay.tolist() == [[0.0, 0.0]]


def test_ligament_stays_and_parts_the_wake() -> None:
    tracker = straight_tracker(50, gap=20)
    assert tracker.tip == (100.0, 0.0)
    wake = crack_wake(tracker, (0.0, 0.0), ELEMENTS)
    before, after = sorted(wake.runs, key=lambda run: float(run[0, 0]))
    assert before[-1].tolist() == [36.0, 0.0] and after[0].tolist() == [46.0, 0.0]
    assert [41.0, 0.0] in wake.stay.tolist()


def test_crack_shorter_than_the_tips_surroundings_has_no_wake() -> None:
    assert crack_wake(straight_tracker(10), (0.0, 0.0), ELEMENTS).runs == []


def test_run_in_place_of_interfaces_leaves_path_and_tip() -> None:
    whole = straight_tracker(50)
    wake = crack_wake(whole, (0.0, 0.0), ELEMENTS)
    (run,) = wake.runs
    first, last = round(run[0, 0] / 2.0), round(run[-1, 0] / 2.0)
    tracker = CrackTracker((0.0, 0.0), 0, broken=last - first)
    tracker.add_run(first, last, run)
    for number in [*range(first), *range(last, 50)]:
        ends = np.array([[[2.0 * number, 0.0], [2.0 * number + 2.0, 0.0]]])
        pairs = np.array([[2 * number, 2 * number + 1]])
        tracker.add(pairs, np.array([[number, number + 1]]), ends)
    assert tracker.tip == whole.tip and tracker.broken == whole.broken
    assert np.array_equal(tracker.crack().path, whole.crack().path)
    assert tracker.path_length == whole.path_length
    again = crack_wake(tracker, (0.0, 0.0), ELEMENTS)
    assert np.array_equal(again.points, wake.points)
