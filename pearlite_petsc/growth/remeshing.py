"""When a crack needs another mesh, and which one."""

import numpy as np
from mpi4py import MPI

from pearlite_petsc.fatigue.damage_state import DamageState
from pearlite_petsc.growth.body import CrackedBody
from pearlite_petsc.growth.prepared import Prepared
from pearlite_petsc.growth.ranks import on_first_rank
from pearlite_petsc.growth.refinement import (
    Refinement,
    carry_damage_over,
    kept_nuclei,
    zone_over,
)
from pearlite_petsc.scene import Elements
from pearlite_petsc.tessellation.mesh import Mesh


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
        refinement = Refinement(zone, kept_nuclei(old, whole))
        mesh = refinement.mesh(prepared.substrate)
        return refinement, mesh, carry_damage_over(old, mesh, carried, whole, failure_cycles)

    return on_first_rank(domain.comm, made) or (Refinement(zone), None, carried)
