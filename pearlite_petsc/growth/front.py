"""The fine zone follows the crack: where it must be fine next, and what is carried over."""

from collections.abc import Mapping, Sequence

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.scene import Kind, Scene
from pearlite_petsc.tessellation.build import Substrate, tessellate
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.zone import NOWHERE, FineZone

ACTIVE_DAMAGE = 0.05
"""Unbroken interfaces with more damage belong to the crack's front."""

CARRIED_DAMAGE = 1e-3
"""Elements whose interfaces have more damage stay when the mesh is replaced."""

MARGIN = 0.5
"""The mesh is replaced when the front comes closer to coarse elements than this share of the radius."""


class Follower:
    """Knows the fine zone, moves it with the front, and tells when the crack is out of bounds.

    Args:
        scene: Window, elements and refinement.
        zone: Fine zone of the first mesh.
    """

    def __init__(self, scene: Scene, zone: FineZone) -> None:
        self._elements, self._window = scene.elements, scene.window
        self.zone = zone
        self.kept: IntArray | None = None

    def is_near_coarse(self, comm: MPI.Comm, front: FloatArray) -> bool:
        """Return whether any rank's front is too close to coarse elements. Collective."""
        if self._elements.refinement != "follow":
            return False
        near = bool((self._depth(front) < MARGIN * self._elements.radius).any())
        return bool(comm.allreduce(near, MPI.LOR))

    def move(self, front: FloatArray) -> None:
        """Cover the front with discs; points closer than a quarter radius share one.

        Args:
            front: Points by rising x, so that those that share a disc lie ahead of its first [um].
        """
        radius = self._elements.radius
        centres = np.empty((0, 2))
        for point in front:
            if not len(centres) or np.hypot(*(centres - point).T).min() > 0.25 * radius:
                centres = np.vstack([centres, point])
        self.zone = NOWHERE.with_discs(centres, radius)

    def mesh(self, substrate: Substrate, old: Mesh, damage: FloatArray) -> Mesh:
        """Return the mesh of the moved zone; elements round damaged interfaces stay."""
        self.kept = kept_nuclei(old, damage)
        return tessellate(substrate, self.zone, self.kept)

    def touches_boundary(self, points: Sequence[tuple[float, float]]) -> bool:
        """Return whether the crack came within one element of the window's edge."""
        edge = max(self._elements.width, self._elements.length)
        right, top = self._window.width - edge, self._window.height - edge
        return any(x > right or not edge < y < top for x, y in points)

    def has_left(self, points: Sequence[tuple[float, float]]) -> bool:
        """Return whether the crack came within two elements of the edge of a corridor."""
        if self._elements.refinement != "corridor":
            return False
        edge = self._elements.corridor - 2.0 * max(self._elements.width, self._elements.length)
        return any(abs(y - 0.5 * self._window.height) > edge for _, y in points)

    def _depth(self, points: FloatArray) -> FloatArray:
        x, y, radius = self.zone.discs.T
        gap = np.hypot(points[:, :1] - x, points[:, 1:] - y)
        return np.asarray((radius - gap).max(axis=1))


def kept_nuclei(mesh: Mesh, damage: FloatArray) -> IntArray:
    """Return the nuclei that must stay: all elements round damaged interfaces."""
    hurt = (damage > CARRIED_DAMAGE) & (mesh.kind != Kind.NOTCH)
    vertices = np.zeros(len(mesh.vertices), dtype=bool)
    vertices[mesh.interface_vertices[hurt].ravel()] = True
    element = np.repeat(np.arange(mesh.element_count), np.diff(mesh.offsets))
    near = np.zeros(mesh.element_count, dtype=bool)
    near[element[vertices[mesh.vertex_indices]]] = True
    near[mesh.interface_elements[hurt].ravel()] = True
    nuclei: IntArray = mesh.nucleus[near]
    return nuclei


def carry_over(old: Mesh, new: Mesh, values: FloatArray, default: FloatArray) -> FloatArray:
    """Return values of the old mesh's interfaces on the new one's, by the nuclei on both sides.

    Args:
        old, new: The meshes.
        values: Of the old mesh's interfaces; (k_old,).
        default: Of new interfaces that the old mesh has not; (k_new,).
    """
    key_old, key_new = interface_keys(old), interface_keys(new)
    order = np.argsort(key_old)
    place = np.searchsorted(key_old, key_new, sorter=order)
    place = order[np.minimum(place, len(order) - 1)]
    return np.where(key_old[place] == key_new, values[place], default)


def carry_damage_over(
    old: Mesh, new: Mesh, values: Mapping[str, FloatArray]
) -> dict[str, FloatArray]:
    """Return ``damage`` and ``failure_cycles`` of the old mesh's interfaces on the new one's.

    New interfaces are intact, the notch's aside.
    """
    notch = new.kind == Kind.NOTCH
    default = {"damage": notch.astype(float), "failure_cycles": np.where(notch, 0.0, np.nan)}
    return {name: carry_over(old, new, values[name], default[name]) for name in default}


def interface_keys(mesh: Mesh) -> IntArray:
    """Return one number per interface that names its two nuclei; (k,)."""
    nuclei = np.sort(mesh.nucleus[mesh.interface_elements], axis=1)
    return np.asarray(nuclei[:, 0] * (np.int64(1) << 32) + nuclei[:, 1])


def interface_pairs(mesh: Mesh, chosen: BoolArray) -> IntArray:
    """Return the nuclei on both sides of some interfaces, smaller first, sorted; (c, 2)."""
    nuclei = np.sort(mesh.nucleus[mesh.interface_elements[chosen]], axis=1)
    return np.asarray(nuclei[np.lexsort(nuclei.T[::-1])])


def notch_tip(mesh: Mesh) -> tuple[tuple[float, float], int]:
    """Return the tip of the notch [um] and its junction."""
    gap = np.hypot(*(mesh.vertices - mesh.notch).T)
    return mesh.notch, int(mesh.junction[int(np.argmin(gap))])
