"""The fine zone follows the front, and what is carried over stays with its nuclei."""

from dataclasses import replace

import numpy as np

from pearlite_petsc.fatigue.damage_state import notched
from pearlite_petsc.growth.refinement import (
    Refinement,
    carry_damage_over,
    carry_over,
    damaged_interfaces,
    interface_pairs,
    kept_nuclei,
    zone_over,
)
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.build import initial_zone, prepare, tessellate
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.zone import AHEAD
from tests.scenes import STATES, default_scene

SCENE = default_scene(elements={"radius": 18.0})
SUBSTRATE = prepare(SCENE, STATES["moderate_AT"], 0)
ZONE = initial_zone(SCENE)
MESH = tessellate(SUBSTRATE, ZONE)


RADIUS = 18.0


def test_front_is_near_coarse_elements_only_beyond_half_the_radius() -> None:
    refinement = Refinement(ZONE)
    ahead = 80.0 + AHEAD * RADIUS
    inside, beyond = (np.array([[ahead + gap, 100.0]]) for gap in (8.9, 9.1))
    assert not refinement.is_near_coarse(np.array([[80.0, 100.0]]), RADIUS)
    assert not refinement.is_near_coarse(inside, RADIUS)
    assert refinement.is_near_coarse(beyond, RADIUS)
    assert refinement.is_near_coarse(np.concatenate([inside, beyond]), RADIUS)


def test_zone_over_a_front_covers_every_point_of_it() -> None:
    front = np.array([[90.0, 100.0], [91.0, 100.0], [120.0, 140.0]])
    zone = zone_over(front, RADIUS)
    assert len(zone.discs) == 2
    assert not Refinement(zone).is_near_coarse(front, RADIUS)


def hurt_near_the_notch() -> tuple[np.ndarray, np.ndarray]:
    """Return which interfaces have damage, and the damage of all."""
    near = np.hypot(*(MESH.midpoint - [82.0, 100.0]).T) < 6.0
    hurt = near & (MESH.kind != Kind.NOTCH)
    rng = np.random.default_rng(7)
    return hurt, np.where(hurt, rng.uniform(0.1, 1.0, len(near)), 0.0)


def moved_mesh(damage: np.ndarray) -> Mesh:
    zone = zone_over(np.array([[130.0, 120.0]]), RADIUS)
    return Refinement(zone, kept_nuclei(MESH, damaged_interfaces(MESH, damage))).mesh(SUBSTRATE)


def test_damaged_interfaces_survive_a_move_with_length_and_value() -> None:
    hurt, damage = hurt_near_the_notch()
    moved = moved_mesh(damage)
    carried = carry_over(MESH, moved, damage, np.zeros(moved.interface_count))
    assert hurt.sum() > 20
    assert np.array_equal(np.sort(carried[carried > 0.0]), np.sort(damage[hurt]))
    length = carry_over(MESH, moved, MESH.length, np.full(moved.interface_count, np.nan))
    assert np.allclose(length[carried > 0.0], moved.length[carried > 0.0], rtol=1e-9)
    assert np.array_equal(interface_pairs(MESH, hurt), interface_pairs(moved, carried > 0.0))


def test_damage_carried_over_keeps_its_cycles_and_the_notch() -> None:
    hurt, damage = hurt_near_the_notch()
    notch = MESH.kind == Kind.NOTCH
    damage = np.where(notch, 1.0, damage)
    failure_cycles = np.where(notch, 0.0, np.where(damage >= 0.8, 7.0, np.nan))
    moved = moved_mesh(damage)
    state = replace(notched(MESH.kind), cycles=9.0).unsolved()
    carried = carry_damage_over(MESH, moved, state, damage, failure_cycles)
    assert carried.cycles == 9.0 and carried.jump is None and not carried.is_solved
    assert (carried.damage[moved.kind == Kind.NOTCH] == 1.0).all()
    assert (carried.failure_cycles[moved.kind == Kind.NOTCH] == 0.0).all()
    assert (carried.failure_cycles == 7.0).sum() == (failure_cycles == 7.0).sum() > 0
    assert ((carried.damage > 0.0) & (moved.kind != Kind.NOTCH)).sum() == hurt.sum()


def test_new_interfaces_take_the_default() -> None:
    moved = tessellate(SUBSTRATE, ZONE.with_discs(np.array([[150.0, 100.0]]), 10.0))
    marks = carry_over(MESH, moved, np.ones(MESH.interface_count), np.zeros(moved.interface_count))
    assert 0 < (marks == 0.0).sum() < moved.interface_count
    assert moved.notch == MESH.notch


def test_nothing_is_kept_round_intact_interfaces() -> None:
    intact = (MESH.kind == Kind.NOTCH).astype(float)
    assert not len(kept_nuclei(MESH, damaged_interfaces(MESH, intact)))
