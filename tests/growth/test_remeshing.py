"""When a crack needs another mesh, and that what it knows goes with it."""

from dataclasses import replace

import numpy as np
from mpi4py import MPI

from pearlite_petsc.fatigue.cycle_jumps.situation import Memory
from pearlite_petsc.fatigue.damage_state import DamageState, notched
from pearlite_petsc.growth.body import CrackedBody
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.growth.refinement import Refinement
from pearlite_petsc.growth.remeshing import needs_another_mesh, next_mesh
from pearlite_petsc.scene import Kind
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    window={"width": 100.0, "height": 100.0, "notch": 40.0},
    elements={"radius": 16.0, "refinement": "follow"},
)
CASE = CrackCase(SCENE, STATES["moderate_AT"], 18e3)
PREPARED = prepare_growth(SCENE, CASE.state, 0)
MESH = PREPARED.mesh
FINE = Refinement(PREPARED.zone)


def state_with(damaged: np.ndarray) -> DamageState:
    """Return a state in which some interfaces have damage 0.3."""
    start = notched(MESH.kind)
    memory = Memory({"rate": np.ones(MESH.interface_count)}, {"delta_d": 0.25})
    damage = np.where(damaged, 0.3, start.damage)
    return replace(start, cycles=70.0, damage=damage, memory=memory)


def near(x: float, y: float) -> np.ndarray:
    """Return whether an interface is among the five nearest to a point."""
    gap = np.hypot(*(MESH.midpoint - [x, y]).T)
    gap[MESH.kind == Kind.NOTCH] = np.inf
    return gap <= np.sort(gap)[4]


def body_of(domain: Domain, state: DamageState) -> CrackedBody:
    return CrackedBody(domain, CASE, state.damage)


def test_another_mesh_is_needed_where_damage_comes_near_coarse_elements() -> None:
    with Domain(MPI.COMM_SELF, SCENE, MESH, PREPARED.ratio) as domain:
        inside, ahead = state_with(near(42.0, 50.0)), state_with(near(58.0, 50.0))
        body = body_of(domain, inside)
        assert not needs_another_mesh(SCENE.elements, body, inside, FINE)
        assert needs_another_mesh(SCENE.elements, body, ahead, FINE)
        uniform = replace(SCENE.elements, refinement="uniform")
        assert not needs_another_mesh(uniform, body, ahead, FINE)


def test_the_next_mesh_is_fine_round_the_front_and_keeps_damage_cycles_and_numbers() -> None:
    damaged = near(58.0, 50.0)
    state = state_with(damaged)
    with Domain(MPI.COMM_SELF, SCENE, MESH, PREPARED.ratio) as domain:
        body = body_of(domain, state)
        refinement, mesh, carried = next_mesh(SCENE.elements, body, state, PREPARED)
    assert mesh is not None and mesh.element_count != MESH.element_count
    front = np.vstack([MESH.midpoint[damaged], MESH.notch])
    assert not refinement.is_near_coarse(front, SCENE.elements.radius)
    assert carried.cycles == 70.0 and carried.memory.numbers == {"delta_d": 0.25}
    assert not carried.memory.by_interface and not carried.is_solved
    hurt = carried.damage == 0.3
    assert hurt.sum() == damaged.sum() == 5
    assert np.array_equal(
        np.sort(mesh.length[hurt].round(9)), np.sort(MESH.length[damaged].round(9))
    )
    assert (carried.damage[mesh.kind == Kind.NOTCH] == 1.0).all()
