"""The fine zone follows the crack: where it must be fine next, and what is carried over."""

from dataclasses import dataclass, replace

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.fatigue.damage_state import DamageState, notched
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.build import Substrate, tessellate
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.wake import Wake
from pearlite_petsc.tessellation.zone import NOWHERE, FineZone

CARRIED_DAMAGE = 1e-3
"""Elements whose interfaces have more damage stay when the mesh is replaced."""

MARGIN = 0.5
"""The mesh is replaced when the front comes closer to coarse elements than this fraction of the
radius."""


@dataclass(frozen=True, slots=True, eq=False)
class Refinement:
    """Where the mesh is fine, and what it keeps of those before.

    Attributes:
        zone: The fine zone.
        kept: Nuclei of earlier meshes that must stay, known on rank 0; (n,). None for the first
            mesh.
        wake: The crack where its elements may coarsen, None where none may.
    """

    zone: FineZone
    kept: IntArray | None = None
    wake: Wake | None = None

    def mesh(self, substrate: Substrate) -> Mesh:
        """Return the mesh."""
        return tessellate(substrate, self.zone, self.kept, self.wake)

    def is_near_coarse(self, front: FloatArray, radius: float) -> bool:
        """Return whether a front's points (p, 2) come too close to coarse elements [um].

        Args:
            front: The points.
            radius: Of the discs that the zone consists of.
        """
        x, y, discs = self.zone.discs.T
        gap = np.hypot(front[:, :1] - x, front[:, 1:] - y)
        depth = (discs - gap).max(axis=1)
        return bool((depth < MARGIN * radius).any())


def zone_over(front: FloatArray, radius: float) -> FineZone:
    """Return discs over a crack's front; points closer than a quarter radius share one.

    Args:
        front: Points by rising x, so that those that share a disc lie ahead of its first [um];
            (p, 2).
        radius: Of the discs [um].
    """
    centres = np.empty((0, 2))
    for point in front:
        if not len(centres) or np.hypot(*(centres - point).T).min() > 0.25 * radius:
            centres = np.vstack([centres, point])
    return NOWHERE.with_discs(centres, radius)


def damaged_interfaces(mesh: Mesh, damage: FloatArray) -> BoolArray:
    """Return the interfaces whose damage D (k,) is worth carrying over; (k,)."""
    return np.asarray((damage > CARRIED_DAMAGE) & (mesh.kind != Kind.NOTCH))


def kept_nuclei(mesh: Mesh, hurt: BoolArray) -> IntArray:
    """Return the nuclei that must stay: all elements round some interfaces (k,)."""
    vertices = np.zeros(len(mesh.vertices), dtype=bool)
    vertices[mesh.interface_vertices[hurt].ravel()] = True
    element = np.repeat(np.arange(mesh.element_count), np.diff(mesh.offsets))
    near = np.zeros(mesh.element_count, dtype=bool)
    near[element[vertices[mesh.vertex_indices]]] = True
    near[mesh.interface_elements[hurt].ravel()] = True
    nuclei: IntArray = mesh.nucleus[near]
    return nuclei[nuclei >= 0]


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
    # What a mesh has cut it knows no damage of: the notch's interfaces and those of the wake.
    same = (key_old[place] == key_new) & (key_new >= 0)
    same &= (old.kind[place] != Kind.NOTCH) & (new.kind != Kind.NOTCH)
    return np.where(same, values[place], default)


def carry_damage_over(
    old: Mesh, new: Mesh, state: DamageState, damage: FloatArray, failure_cycles: FloatArray
) -> DamageState:
    """Return a state of damage on a new mesh, whose new interfaces are intact, the notch's aside.

    Args:
        old, new: The meshes.
        state: Cycles, and what the cycle jump remembers of no interface.
        damage, failure_cycles: Of the old mesh's interfaces; (k_old,).
    """
    start = notched(new.kind)
    return replace(
        state,
        damage=carry_over(old, new, damage, start.damage),
        failure_cycles=carry_over(old, new, failure_cycles, start.failure_cycles),
    )


def interface_keys(mesh: Mesh) -> IntArray:
    """Return one number per interface that names its two nuclei, negative where one is of no lattice; (k,)."""
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
