"""Fields of a growing crack on elements and interfaces, ready to be written or drawn.

Elements are fanned into triangles with points of their own, so that a warped picture opens the
crack; triangle t belongs to element ``owner[t]``.
"""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray, read_only
from pearlite_petsc.fatigue.outcome import GrowthState
from pearlite_petsc.mechanics.kinematics import jump_operator, jumps, spring_constants
from pearlite_petsc.mechanics.springs import Stiffness
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Fan:
    """Triangles of all polygons.

    Attributes:
        points: Corners of polygon 0, of polygon 1, ...; (p, 2) [um].
        point_owner: Element of each point; (p,).
        triangles: (t, 3).
        owner: Element of each triangle; (t,).
    """

    points: FloatArray
    point_owner: IntArray
    triangles: IntArray
    owner: IntArray


def fan(mesh: Mesh) -> Fan:
    """Return the polygons as triangles from each one's first corner."""
    corners = np.diff(mesh.offsets)
    owner = np.repeat(np.arange(mesh.element_count), corners - 2)
    first = np.repeat(np.cumsum(corners - 2) - (corners - 2), corners - 2)
    step = np.arange(len(owner)) - first
    base = mesh.offsets[owner]
    return Fan(
        points=read_only(mesh.vertices[mesh.vertex_indices]),
        point_owner=read_only(np.repeat(np.arange(mesh.element_count), corners)),
        triangles=read_only(np.stack([base, base + step + 1, base + step + 2], axis=1)),
        owner=read_only(owner),
    )


def point_displacement(mesh: Mesh, shape: Fan, state: GrowthState) -> FloatArray:
    """Return u + theta z x (p - c) of each point [um]; shape (p, 3), z = 0.

    Loose elements hang on nothing, so their displacement is undetermined: they stay in place.
    """
    motion = np.where(state.loose[:, None], 0.0, state.displacement)[shape.point_owner]
    arm = shape.points - mesh.centre[shape.point_owner]
    moved = np.zeros((len(arm), 3))
    moved[:, 0] = motion[:, 0] - motion[:, 2] * arm[:, 1]
    moved[:, 1] = motion[:, 1] + motion[:, 2] * arm[:, 0]
    return moved


def mean_damage(mesh: Mesh, damage: FloatArray) -> FloatArray:
    """Return the mean D of each element's interfaces, weighted by their lengths; shape (n,)."""
    weight = np.where(mesh.kind == Kind.NOTCH, 0.0, mesh.length)
    total = _to_elements(mesh, weight)
    return np.asarray(_to_elements(mesh, weight * damage) / np.where(total > 0.0, total, 1.0))


def element_stress(mesh: Mesh, state: GrowthState, stiffness: Stiffness) -> FloatArray:
    """Return the mean stress of each element under delta_k [MPa]; shape (n, 2, 2), symmetric.

    For a body in equilibrium the mean stress is 1/A times the integral of (x - c) (x) t over its
    boundary. An interface carries the force F at its midpoint m and the moment M, Eq. (13)-(15),
    which add (m - c) (x) F + M e_t (x) e_n, the springs softened by 1 - D. What the window's
    boundary puts on an element is the rest of its equilibrium, force and moment at the facet's
    midpoint. NaN where an element has two facets of the window's boundary (corners), which that
    does not tell apart, and for loose elements.
    """
    moments, resultant = force_moments(mesh, state, stiffness)
    _close_boundary(mesh, moments, resultant)
    moments[state.loose] = np.nan
    stress = moments / mesh.area[:, None, None]
    return np.asarray(0.5 * (stress + np.swapaxes(stress, 1, 2)))


def force_moments(
    mesh: Mesh, state: GrowthState, stiffness: Stiffness
) -> tuple[FloatArray, FloatArray]:
    """Return what an element's interfaces add to its mean stress, and their resultant.

    Returns:
        Sum of (m - c) (x) F + M e_t (x) e_n [uN um], symmetric in equilibrium where no facet lies
        on the window's boundary; (n, 2, 2). Sum of F [uN]; (n, 2).
    """
    i, j = mesh.interface_elements.T
    normal = mesh.normal
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    operator = jump_operator(mesh.centre, mesh.interface_elements, mesh.midpoint, normal, 1.0)
    jump = jumps(operator, state.displacement[i], state.displacement[j])
    intact = np.where(mesh.kind == Kind.NOTCH, 0.0, 1.0 - state.damage)
    pull, slide, turn = (intact[:, None] * spring_constants(stiffness, mesh.length) * jump).T
    bend = -turn  # in these axes tension that grows along the tangent is a negative moment
    force = pull[:, None] * normal + slide[:, None] * tangent
    couple = bend[:, None, None] * tangent[:, :, None] * normal[:, None, :]

    moments = np.zeros((mesh.element_count, 2, 2))
    resultant = np.zeros((mesh.element_count, 2))
    for element, sign in ((i, 1.0), (j, -1.0)):
        arm = mesh.midpoint - mesh.centre[element]
        np.add.at(moments, element, sign * (arm[:, :, None] * force[:, None, :] + couple))
        np.add.at(resultant, element, sign * force)
    return moments, resultant


def _close_boundary(mesh: Mesh, moments: FloatArray, resultant: FloatArray) -> None:
    element = mesh.boundary_elements
    start, end = np.swapaxes(mesh.vertices[mesh.boundary_vertices], 0, 1)
    arm = 0.5 * (start + end) - mesh.centre[element]
    tangent = (end - start) / np.linalg.norm(end - start, axis=1)[:, None]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    np.add.at(moments, element, arm[:, :, None] * -resultant[element][:, None, :])
    torque = moments[element, 0, 1] - moments[element, 1, 0]
    np.add.at(moments, element, torque[:, None, None] * tangent[:, :, None] * normal[:, None, :])
    moments[np.bincount(element, minlength=mesh.element_count) > 1] = np.nan


def _to_elements(mesh: Mesh, values: FloatArray) -> FloatArray:
    i, j = mesh.interface_elements.T
    count = mesh.element_count
    return np.asarray(
        np.bincount(i, weights=values, minlength=count)
        + np.bincount(j, weights=values, minlength=count)
    )
