"""When a crack needs another mesh, and which one."""

from dataclasses import replace

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.damage_state import DamageState
from pearlite_petsc.growth.body import CrackedBody
from pearlite_petsc.growth.prepared import Prepared
from pearlite_petsc.growth.ranks import on_first_rank
from pearlite_petsc.growth.refinement import (
    Refinement,
    carry_damage_over,
    damaged_interfaces,
    kept_nuclei,
    zone_over,
)
from pearlite_petsc.growth.wake import crack_wake, lost_pairs, staying_interfaces
from pearlite_petsc.scene import Elements
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.wake import Wake


def needs_another_mesh(
    elements: Elements, body: CrackedBody, damage: DamageState, refinement: Refinement
) -> bool:
    """Return whether the crack's front is too close to coarse elements anywhere. Collective."""
    if elements.refinement != "follow":
        return False
    near = refinement.is_near_coarse(body.front(damage.damage), elements.radius)
    return bool(body.domain.comm.allreduce(near, MPI.LOR))


def next_mesh(
    elements: Elements, body: CrackedBody, damage: DamageState, prepared: Prepared | None
) -> tuple[Refinement, Mesh | None, DamageState]:
    """Return a mesh whose fine zone covers the crack's front, and the damage on it. Collective.

    Args:
        elements: Radius of the fine zone's discs.
        body: The mesh of now and the crack in it.
        damage: Of this rank's interfaces.
        prepared: The microstructure on rank 0, None elsewhere.

    Returns:
        Refinement, mesh on rank 0, and damage, whose arrays are those of the whole mesh on rank 0
        and mean nothing elsewhere.
    """
    domain = body.domain
    fronts = domain.comm.allgather(body.front(damage.damage))
    # Sorted, so that the fine zone does not depend on which rank found which point.
    zone = zone_over(np.unique(np.concatenate(fronts), axis=0), elements.radius)
    whole, failure_cycles = (
        domain.gather(values) for values in (damage.damage, damage.failure_cycles)
    )
    carried = damage.unsolved()

    def made() -> tuple[Refinement, Mesh, DamageState]:
        old = domain.mesh
        assert prepared is not None and old is not None
        assert whole is not None and failure_cycles is not None
        refinement = Refinement(zone, *_carried(elements, body, old, whole))
        mesh = refinement.mesh(prepared.substrate)
        if refinement.wake is not None:
            pairs = [refinement.wake.pairs, lost_pairs(old, mesh, whole)]
            wake = replace(refinement.wake, pairs=np.concatenate(pairs))
            refinement = replace(refinement, wake=wake)
        return refinement, mesh, carry_damage_over(old, mesh, carried, whole, failure_cycles)

    refinement, mesh, carried = on_first_rank(domain.comm, made) or (
        Refinement(zone),
        None,
        carried,
    )
    wake = domain.comm.bcast(refinement.wake)
    return replace(refinement, wake=wake), mesh, carried


def _carried(
    elements: Elements, body: CrackedBody, mesh: Mesh, damage: FloatArray
) -> tuple[IntArray, Wake | None]:
    """Return the nuclei that stay, and the wake in place of the others."""
    if elements.wake == "fine":
        return kept_nuclei(mesh, damaged_interfaces(mesh, damage)), None
    wake = crack_wake(body.tracker, mesh.notch, elements)
    staying = staying_interfaces(mesh, damage, wake, body.tracker.tip, elements)
    fixed = mesh.vertices[np.unique(mesh.interface_vertices[staying])]
    pairs = np.empty((0, 2), dtype=np.int64) if body.wake is None else body.wake.pairs
    return kept_nuclei(mesh, staying), replace(wake, fixed=fixed, pairs=pairs)
