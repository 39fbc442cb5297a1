"""Equilibrium of a whole body by SciPy's direct solver, independent of the solver on PETSc."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.mechanics.kinematics import (
    jump_operator,
    jumps,
    rotation_length,
    spring_constants,
    stiffness_blocks,
)
from pearlite_petsc.mechanics.loads import AiryFunction, element_forces
from pearlite_petsc.mechanics.springs import Stiffness
from pearlite_petsc.tessellation.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Equilibrium under one load.

    Attributes:
        unknowns: (X, Y, phi) [um]; (n, 3).
        traction: Normal and tangential traction of each interface, 0 where broken [MPa]; (k, 2).
        force: Normal and tangential force and moment of each interface [uN, uN, uN um]; (k, 3).
        energy: Elastic energy, half the work of the load [uN um].
        residual: Largest unbalanced force or moment over the largest force of an interface.
    """

    unknowns: FloatArray
    traction: FloatArray
    force: FloatArray
    energy: float
    residual: float


def load_vector(mesh: Mesh, airy: AiryFunction) -> FloatArray:
    """Return (F_x, F_y, M/length) on each element from a stress function [uN]; (n, 3)."""
    start, end = (mesh.vertices[mesh.boundary_vertices[:, side]] for side in (0, 1))
    load = element_forces(start, end, mesh.boundary_elements, mesh.centre, airy)
    return load / [1.0, 1.0, rotation_length(mesh)]


def operators(mesh: Mesh, stiffness: Stiffness) -> tuple[FloatArray, FloatArray]:
    """Return B (k, 3, 6) and the spring constants (k, 3) of all interfaces."""
    pairs = mesh.interface_elements
    operator = jump_operator(mesh.centre, pairs, mesh.midpoint, mesh.normal, rotation_length(mesh))
    return operator, spring_constants(stiffness, mesh.length)


def stiffness_matrix(mesh: Mesh, operator: FloatArray, constants: FloatArray) -> csc_array:
    """Return the stiffness matrix (3n, 3n)."""
    blocks = stiffness_blocks(operator, constants)
    unknown = (3 * mesh.interface_elements[:, :, None] + np.arange(3)).reshape(-1, 6)
    rows, columns = np.repeat(unknown, 6, axis=1).ravel(), np.tile(unknown, 6).ravel()
    size = 3 * mesh.element_count
    return coo_array((blocks.ravel(), (rows, columns)), shape=(size, size)).tocsc()


def solve_loads(
    mesh: Mesh, stiffness: Stiffness, broken: BoolArray, loads: Sequence[AiryFunction]
) -> list[Solution]:
    """Return the equilibrium of a body under each of some loads that balance themselves.

    Args:
        mesh: The body; its intact interfaces hold it together.
        stiffness: Springs of all interfaces.
        broken: Interfaces taken out; (k,).
        loads: Stress functions of the loads on the whole boundary.
    """
    operator, constants = operators(mesh, stiffness)
    constants = constants * ~broken[:, None]
    matrix = stiffness_matrix(mesh, operator, constants)
    # One element held takes the rigid motion out; the load balances itself.
    held = 3 * int(np.argmax(mesh.centre @ [1.0, 0.0]))
    free = np.delete(np.arange(matrix.shape[0]), range(held, held + 3))
    factor = splu(
        matrix[free][:, free], permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
    )
    i, j = mesh.interface_elements.T
    found = []
    for airy in loads:
        load = load_vector(mesh, airy).ravel()
        unknowns = np.zeros(load.size)
        unknowns[free] = factor.solve(load[free])
        motion = unknowns.reshape(-1, 3)
        force = constants * jumps(operator, motion[i], motion[j])
        found.append(
            Solution(
                motion,
                force[:, :2] / mesh.length[:, None],
                force,
                0.5 * float(load @ unknowns),
                float(np.abs(load - matrix @ unknowns).max() / np.abs(force[:, :2]).max()),
            )
        )
    return found


def solve(mesh: Mesh, stiffness: Stiffness, broken: BoolArray, airy: AiryFunction) -> Solution:
    """Return the equilibrium of a body under one load; as ``solve_loads``."""
    (solution,) = solve_loads(mesh, stiffness, broken, [airy])
    return solution
