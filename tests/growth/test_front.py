"""The fine zone follows the front, and what is carried over stays with its nuclei."""

import numpy as np
from mpi4py import MPI

from pearlite_petsc.growth.front import Follower, carry_over, interface_pairs, kept_nuclei
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.build import initial_zone, prepare, tessellate
from pearlite_petsc.tessellation.zone import AHEAD
from tests.scenes import STATES, default_scene

SCENE = default_scene(elements={"radius": 18.0})
SUBSTRATE = prepare(SCENE, STATES["moderate_AT"], 0)
ZONE = initial_zone(SCENE)
MESH = tessellate(SUBSTRATE, ZONE)


def test_front_is_near_coarse_elements_only_beyond_half_the_radius() -> None:
    follower = Follower(SCENE, ZONE)
    ahead = 80.0 + AHEAD * 18.0
    inside, beyond = (np.array([[ahead + gap, 100.0]]) for gap in (8.9, 9.1))
    assert not follower.is_near_coarse(MPI.COMM_SELF, np.array([[80.0, 100.0]]))
    assert not follower.is_near_coarse(MPI.COMM_SELF, inside)
    assert follower.is_near_coarse(MPI.COMM_SELF, beyond)


def test_moved_zone_covers_every_point_of_the_front() -> None:
    follower = Follower(SCENE, ZONE)
    front = np.array([[90.0, 100.0], [91.0, 100.0], [120.0, 140.0]])
    follower.move(front)
    assert len(follower.zone.discs) == 2
    assert not follower.is_near_coarse(MPI.COMM_SELF, front)


def test_damaged_interfaces_survive_a_move_with_length_and_value() -> None:
    follower = Follower(SCENE, ZONE)
    near = np.hypot(*(MESH.midpoint - [82.0, 100.0]).T) < 6.0
    hurt = near & (MESH.kind != Kind.NOTCH)
    rng = np.random.default_rng(7)
    damage = np.where(hurt, rng.uniform(0.1, 1.0, len(near)), 0.0)
    follower.move(np.array([[130.0, 120.0]]))
    moved = follower.mesh(SUBSTRATE, MESH, damage)
    carried = carry_over(MESH, moved, damage, np.zeros(moved.interface_count))
    assert hurt.sum() > 20
    assert np.array_equal(np.sort(carried[carried > 0.0]), np.sort(damage[hurt]))
    length = carry_over(MESH, moved, MESH.length, np.full(moved.interface_count, np.nan))
    assert np.allclose(length[carried > 0.0], moved.length[carried > 0.0], rtol=1e-9)
    assert np.array_equal(interface_pairs(MESH, hurt), interface_pairs(moved, carried > 0.0))


def test_new_interfaces_take_the_default() -> None:
    moved = tessellate(SUBSTRATE, ZONE.with_discs(np.array([[150.0, 100.0]]), 10.0))
    marks = carry_over(MESH, moved, np.ones(MESH.interface_count), np.zeros(moved.interface_count))
    assert 0 < (marks == 0.0).sum() < moved.interface_count
    assert moved.notch == MESH.notch


def test_nothing_is_kept_round_intact_interfaces() -> None:
    assert not len(kept_nuclei(MESH, (MESH.kind == Kind.NOTCH).astype(float)))
