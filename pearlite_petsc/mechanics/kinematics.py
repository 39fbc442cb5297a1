"""Jumps across interfaces and the stiffness that they give, Eq. (1)-(18).

The unknowns of an element are (X, Y, phi) with phi = theta times a length, so that all three
rows of the stiffness matrix have one unit [uN/um].
"""

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.mechanics.springs import Stiffness
from pearlite_petsc.tessellation.mesh import Mesh


def rotation_length(mesh: Mesh) -> float:
    """Return the length that scales rotations: sqrt of the fine elements' mean area [um]."""
    area = mesh.area[mesh.fine] if mesh.fine.any() else mesh.area
    return float(np.sqrt(area.mean()))


def jump_operator(
    centre: FloatArray, pairs: IntArray, midpoint: FloatArray, normal: FloatArray, rotation: float
) -> FloatArray:
    """Return B of each interface: (normal jump, tangential jump, theta_j - theta_i) from unknowns.

    The jump at the midpoint m is (u_j + theta_j z x (m - c_j)) - (u_i + theta_i z x (m - c_i)),
    Eq. (1)-(5); the tangent is z x n.

    Args:
        centre: Element centres [um]; shape (n, 2).
        pairs: Elements i, j of each interface; shape (k, 2).
        midpoint: [um]; shape (k, 2).
        normal: Unit normal from i to j; shape (k, 2).
        rotation: Length that scales the rotations [um].

    Returns:
        B for the unknowns (X_i, Y_i, phi_i, X_j, Y_j, phi_j); shape (k, 3, 6).
    """
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    operator = np.zeros((len(pairs), 3, 6))
    for element, sign, first in ((pairs[:, 0], -1.0, 0), (pairs[:, 1], 1.0, 3)):
        arm = midpoint - centre[element]
        turned = np.stack([-arm[:, 1], arm[:, 0]], axis=1)
        for row, direction in ((0, normal), (1, tangent)):
            operator[:, row, first : first + 2] = sign * direction
            lever = np.einsum("kd,kd->k", direction, turned)
            operator[:, row, first + 2] = sign * lever / rotation
        operator[:, 2, first + 2] = sign / rotation
    return operator


def spring_constants(stiffness: Stiffness, length: FloatArray) -> FloatArray:
    """Return (k_n l, k_t l, k_n l^3/12) of each interface, Eq. (13)-(15); shape (k, 3)."""
    return np.stack(
        [stiffness.k_n * length, stiffness.k_t * length, stiffness.k_n * length**3 / 12.0], axis=1
    )


def stiffness_blocks(operator: FloatArray, constants: FloatArray) -> FloatArray:
    """Return B^T diag(constants) B of each interface; shape (k, 6, 6)."""
    return np.asarray(np.swapaxes(operator, 1, 2) @ (constants[:, :, None] * operator))


def rigid_modes(centre: FloatArray, rotation: float, origin: FloatArray) -> FloatArray:
    """Return the three rigid motions (1,0,0), (0,1,0), (-y,x,1) about the origin.

    Args:
        centre: Element centres [um]; shape (n, 2).
        rotation: Length that scales the rotations [um].
        origin: Point that the third mode turns about [um]; shape (2,).

    Returns:
        Unknowns of each mode, not normalised; shape (n, 3 unknowns, 3 modes).
    """
    modes = np.zeros((len(centre), 3, 3))
    modes[:, 0, 0] = modes[:, 1, 1] = 1.0
    arm = centre - origin
    modes[:, 0, 2], modes[:, 1, 2], modes[:, 2, 2] = -arm[:, 1], arm[:, 0], rotation
    return modes


def jumps(operator: FloatArray, unknowns_i: FloatArray, unknowns_j: FloatArray) -> FloatArray:
    """Return (normal, tangential, rotational) jumps from both elements' unknowns; shape (k, 3)."""
    left = np.einsum("krc,kc->kr", operator[:, :, :3], unknowns_i)
    return np.asarray(left + np.einsum("krc,kc->kr", operator[:, :, 3:], unknowns_j))
