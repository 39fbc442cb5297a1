"""Cracks of one mesh share its first matrix and preconditioner, and are what they are alone."""

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import Prepared, prepare_growth
from pearlite_petsc.growth.shared_domain import SharedDomain
from pearlite_petsc.scene import Scene, Solver
from tests.scenes import STATES, default_scene

LEVELS = 12e3, 18e3


def small_scene(method: str, refinement: str) -> Scene:
    return default_scene(
        states=(STATES["moderate_AT"],),
        window={"width": 80.0, "height": 80.0, "notch": 40.0},
        elements={"width": 3.0, "refinement": refinement},
        loading={"delta_k": LEVELS, "extension": 12.0},
        solver=Solver(method, 1e-9, 20000),  # type: ignore[arg-type]
    )


def grown(scene: Scene, prepared: Prepared, delta_k: float, shared: Domain | None) -> Outcome:
    state = scene.states[0]
    growth = CrackGrowth(MPI.COMM_SELF, scene, state, delta_k, prepared, shared=shared)
    outcome = growth.grown()
    assert outcome is not None
    return outcome


@pytest.mark.parametrize(
    ("method", "refinement"),
    [
        ("iterative", "follow"),
        ("iterative", "uniform"),
        ("factors", "follow"),
        ("direct", "uniform"),
    ],
)
def test_cracks_on_a_shared_domain_are_the_same_bit_for_bit(method: str, refinement: str) -> None:
    scene = small_scene(method, refinement)
    prepared = prepare_growth(scene, scene.states[0], 0)
    shared = SharedDomain(MPI.COMM_SELF, scene)
    domain = shared.domain(0, prepared)
    for delta_k in LEVELS:
        again = shared.domain(0, prepared)
        assert again is domain
        one, alone = (grown(scene, prepared, delta_k, domain) for domain in (again, None))
        assert len(one.history) > 3
        assert np.array_equal(one.history, alone.history)
        assert one.effort.counters == alone.effort.counters
    shared.close()


def test_another_microstructure_gets_a_domain_of_its_own() -> None:
    scene = small_scene("iterative", "follow")
    shared = SharedDomain(MPI.COMM_SELF, scene)
    made = [prepare_growth(scene, scene.states[0], index) for index in range(2)]
    domains = [shared.domain(number, prepared) for number, prepared in enumerate(made)]
    assert domains[0].mesh is made[0].mesh
    assert domains[1].mesh is made[1].mesh
    shared.close()


def test_a_closed_domain_is_made_anew() -> None:
    scene = small_scene("iterative", "follow")
    prepared = prepare_growth(scene, scene.states[0], 0)
    shared = SharedDomain(MPI.COMM_SELF, scene)
    before = shared.domain(0, prepared)
    shared.close()
    after = shared.domain(0, prepared)
    assert after is not before
    assert grown(scene, prepared, LEVELS[0], after).effort.solves > 3
    shared.close()
