"""Where the growth of a crack starts: at its notch, or where it was saved."""

from contextlib import ExitStack
from dataclasses import dataclass

from mpi4py import MPI

from pearlite_petsc.fatigue.damage_state import DamageState, notched
from pearlite_petsc.growth.body import CrackedBody
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.checkpoint import Checkpoint
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.prepared import Prepared
from pearlite_petsc.growth.ranks import on_first_rank
from pearlite_petsc.growth.record import Record, new_record
from pearlite_petsc.growth.refinement import Refinement
from pearlite_petsc.growth.shared_domain import first_domain
from pearlite_petsc.tessellation.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """Where a crack stands when its growth starts.

    Attributes:
        body: Its mesh and the crack in it.
        damage: Where the damage of the mesh's interfaces stands.
        refinement: Where the mesh is fine.
        record: What was measured and counted so far.
    """

    body: CrackedBody
    damage: DamageState
    refinement: Refinement
    record: Record


def from_notch(
    comm: MPI.Comm, case: CrackCase, prepared: Prepared | None, shared: Domain | None
) -> Start:
    """Return where a crack stands at its notch. Collective.

    Args:
        comm: The group.
        case: The crack.
        prepared: Microstructure and first mesh on rank 0, None elsewhere.
        shared: Domain of the first mesh as it is at the start; None makes one.
    """
    zone = comm.bcast(None if prepared is None else prepared.zone)
    with ExitStack() as stack:
        domain = shared or stack.enter_context(first_domain(comm, case.scene, prepared))
        damage = notched(domain.subdomain.interfaces.kind)
        body = CrackedBody(domain, case, damage.damage)
        stack.pop_all()
    return Start(body, damage, Refinement(zone), new_record(body.tracker.tip[0]))


def from_checkpoint(
    comm: MPI.Comm, case: CrackCase, prepared: Prepared | None, saved: Checkpoint
) -> Start:
    """Return where a crack stood when it was saved. Collective.

    Args:
        comm: The group, as large as then.
        case: The crack.
        prepared: Microstructure and first mesh on rank 0, None elsewhere.
        saved: The checkpoint on rank 0, the one ``without_arrays`` elsewhere.
    """
    mesh = on_first_rank(comm, lambda: _mesh(prepared, saved))
    ratio = None if prepared is None else prepared.ratio
    with ExitStack() as stack:
        whole = saved.damage.damage
        domain = stack.enter_context(Domain(comm, case.scene, mesh, ratio, whole))
        local = saved.scattered(domain)
        body = CrackedBody(domain, case, local.damage.damage, local.refinement.wake)
        domain.equilibrium.restore(local.equilibrium)
        if local.coupling is not None:
            body.coupling.restore(local.coupling)
        # The record has what was counted until then.
        domain.equilibrium.counters.clear()
        stack.pop_all()
    return Start(body, local.damage, local.refinement, local.record)


def _mesh(prepared: Prepared | None, saved: Checkpoint) -> Mesh:
    assert prepared is not None
    return saved.refinement.mesh(prepared.substrate) if saved.record.refinements else prepared.mesh
