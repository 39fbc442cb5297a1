from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.mechanics.kinematics import (
    jump_operator,
    jumps,
    rigid_modes,
    rotation_length,
    spring_constants,
    stiffness_blocks,
)
from pearlite_petsc.mechanics.springs import Stiffness
from pearlite_petsc.studies.bodies import plain_mesh, random_points, rotated, rotation
from pearlite_petsc.tessellation.mesh import Mesh

RNG = np.random.default_rng(11)
MESH = plain_mesh(random_points(40, 9.0, 7.0, seed=6), 9.0, 7.0)
LENGTH = rotation_length(MESH)


def operator(mesh: Mesh = MESH, length: float = LENGTH) -> FloatArray:
    return jump_operator(mesh.centre, mesh.interface_elements, mesh.midpoint, mesh.normal, length)


def scalar_jump(mesh: Mesh, interface: int, motion: FloatArray) -> list[float]:
    """(normal, tangential, rotational) jump of one interface from (X, Y, theta) of its elements."""
    place = mesh.midpoint[interface].tolist()
    nx, ny = mesh.normal[interface].tolist()
    moved = []
    for element in mesh.interface_elements[interface].tolist():
        x, y, theta = motion[element].tolist()
        cx, cy = mesh.centre[element].tolist()
        moved.append((x - theta * (place[1] - cy), y + theta * (place[0] - cx), theta))
    (xi, yi, ti), (xj, yj, tj) = moved
    jx, jy = xj - xi, yj - yi
    return [jx * nx + jy * ny, -jx * ny + jy * nx, tj - ti]


def test_jumps_are_those_of_the_rigid_motions_interface_by_interface() -> None:
    motion = RNG.normal(size=(MESH.element_count, 3))
    unknowns = motion * [1.0, 1.0, LENGTH]
    i, j = MESH.interface_elements.T
    found = jumps(operator(), unknowns[i], unknowns[j])
    for interface in range(MESH.interface_count):
        assert found[interface] == pytest.approx(scalar_jump(MESH, interface, motion), abs=1e-12)


def test_jumps_do_not_depend_on_the_length_that_scales_rotations() -> None:
    motion = RNG.normal(size=(MESH.element_count, 3))
    i, j = MESH.interface_elements.T
    found = []
    for length in (0.1, 1.0, 30.0):
        unknowns = motion * [1.0, 1.0, length]
        found.append(jumps(operator(MESH, length), unknowns[i], unknowns[j]))
    assert np.allclose(found[0], found[1], rtol=0, atol=1e-12)
    assert np.allclose(found[1], found[2], rtol=0, atol=1e-12)


def test_rigid_motions_open_no_interface() -> None:
    origin = np.array([3.0, -2.0])
    modes = rigid_modes(MESH.centre, LENGTH, origin)
    i, j = MESH.interface_elements.T
    for mode in range(3):
        found = jumps(operator(), modes[i, :, mode], modes[j, :, mode])
        assert np.abs(found).max() < 1e-13 * np.abs(modes).max()
    assert np.linalg.matrix_rank(modes.reshape(-1, 3)) == 3


def test_the_third_rigid_mode_turns_about_its_origin() -> None:
    modes = rigid_modes(np.array([[2.0, 5.0], [2.0, 6.0]]), 4.0, np.array([2.0, 5.0]))
    assert modes[0, :, 2].tolist() == [0.0, 0.0, 4.0]
    assert modes[1, :, 2].tolist() == [-1.0, 0.0, 4.0]


def test_a_turn_about_the_interface_gives_a_rotational_jump_alone() -> None:
    interface = 5
    element = MESH.interface_elements[interface, 1]
    arm = MESH.centre[element] - MESH.midpoint[interface]
    motion = np.zeros((MESH.element_count, 3))
    motion[element] = [-0.2 * arm[1], 0.2 * arm[0], 0.2]
    unknowns = motion * [1.0, 1.0, LENGTH]
    i, j = MESH.interface_elements.T
    found = jumps(operator(), unknowns[i], unknowns[j])[interface]
    assert found == pytest.approx([0.0, 0.0, 0.2], abs=1e-14)


def test_moving_the_second_element_along_the_normal_opens_the_interface() -> None:
    unknowns = np.zeros((MESH.interface_count, 3))
    moved = np.column_stack([MESH.normal, np.zeros(MESH.interface_count)])
    assert np.allclose(jumps(operator(), unknowns, moved), [1.0, 0.0, 0.0], atol=1e-14)
    assert np.allclose(jumps(operator(), moved, unknowns), [-1.0, 0.0, 0.0], atol=1e-14)


def test_the_tangent_is_the_normal_turned_counter_clockwise() -> None:
    tangent = MESH.normal @ rotation(0.5 * np.pi).T
    moved = np.column_stack([tangent, np.zeros(MESH.interface_count)])
    found = jumps(operator(), np.zeros_like(moved), moved)
    assert np.allclose(found, [0.0, 1.0, 0.0], atol=1e-14)


def test_jumps_of_a_turned_problem_are_the_same() -> None:
    turn = 0.7
    motion = RNG.normal(size=(MESH.element_count, 3))
    other = np.column_stack([motion[:, :2] @ rotation(turn).T, motion[:, 2]])
    i, j = MESH.interface_elements.T
    here = jumps(operator(), motion[i], motion[j])
    there = jumps(operator(rotated(MESH, turn)), other[i], other[j])
    assert np.allclose(here, there, rtol=0, atol=1e-12)


def test_spring_constants_are_forces_and_the_moment_of_a_spread_spring() -> None:
    stiffness = Stiffness(np.array([3.0, 5.0]), np.array([7.0, 11.0]))
    found = spring_constants(stiffness, np.array([2.0, 4.0]))
    assert found.tolist() == [[6.0, 14.0, 2.0], [20.0, 44.0, 5.0 * 64.0 / 12.0]]


def test_the_moment_constant_is_the_integral_of_the_spread_springs() -> None:
    length, k_n = 3.0, 2.0
    moment = quad(lambda place: k_n * place**2, -0.5 * length, 0.5 * length)[0]
    found = spring_constants(Stiffness(np.array([k_n]), np.array([0.0])), np.array([length]))
    assert found[0, 2] == pytest.approx(moment, rel=1e-12)


def test_blocks_are_symmetric_semidefinite_and_twice_the_energy() -> None:
    constants = RNG.uniform(0.5, 2.0, size=(MESH.interface_count, 3))
    blocks = stiffness_blocks(operator(), constants)
    assert np.allclose(blocks, np.swapaxes(blocks, 1, 2), rtol=0, atol=1e-13 * np.abs(blocks).max())
    values = np.linalg.eigvalsh(blocks)
    assert values[:, 0].min() > -1e-12 * values.max()
    # Six unknowns, three springs: three motions cost nothing.
    assert np.abs(values[:, :3]).max() < 1e-12 * values.max()
    assert values[:, 3].min() > 0
    for interface in (0, 9, 30):
        unknowns = RNG.normal(size=6)
        jump = operator()[interface] @ unknowns
        energy = float((constants[interface] * jump**2).sum())
        assert unknowns @ blocks[interface] @ unknowns == pytest.approx(energy, rel=1e-12)


def test_the_rotation_length_is_that_of_a_fine_element() -> None:
    assert pytest.approx(np.sqrt(63.0 / 40.0)) == LENGTH
    fine = np.zeros(MESH.element_count, dtype=bool)
    fine[3] = True
    assert rotation_length(replace(MESH, fine=fine)) == pytest.approx(np.sqrt(MESH.area[3]))
    none = np.zeros(MESH.element_count, dtype=bool)
    assert rotation_length(replace(MESH, fine=none)) == pytest.approx(LENGTH)
