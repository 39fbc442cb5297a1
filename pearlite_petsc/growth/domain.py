"""One mesh on the ranks of a group: who has what, the solver, and what travels between ranks."""

from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, IntArray, read_only
from pearlite_petsc.growth.ranks import on_first_rank
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.scene import Kind, Scene
from pearlite_petsc.solver.closing import Closing
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.owners import local_interfaces
from pearlite_petsc.solver.subdomain import Subdomain, element_ranges, subdomain_of
from pearlite_petsc.tessellation.mesh import Mesh


class Domain(Closing):
    """A mesh and its equilibrium on this rank's subdomain. Collective; close it.

    Attributes:
        comm: The group.
        mesh: The mesh on rank 0, None elsewhere.
        subdomain: This rank's.
        equilibrium: Solves for the motions of its elements.

    Args:
        comm, mesh: As above.
        scene: Springs and solver.
        ratio: k_t/k_n of ``matched`` springs.
        damage: D of all interfaces at the start on rank 0; None for an intact mesh with its notch.
        keep_first: Whether ``rewind`` will be wanted.
    """

    def __init__(
        self,
        comm: MPI.Comm,
        scene: Scene,
        mesh: Mesh | None,
        ratio: float | None,
        damage: FloatArray | None = None,
        keep_first: bool = False,
    ) -> None:
        self.comm, self.mesh = comm, mesh
        self.subdomain = _distribute(comm, scene, mesh, ratio)
        self._interfaces = comm.gather(self.subdomain.interfaces.numbers)
        if mesh is not None and damage is None:
            damage = (mesh.kind == Kind.NOTCH).astype(float)
        start = self.scatter(damage)
        self.equilibrium = Equilibrium(comm, self.subdomain, start, scene.solver, keep_first)

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        self.equilibrium.close()

    def rewind(self) -> None:
        """Go back to the preconditioner of the start. Collective."""
        self.equilibrium.rewind()

    def gather(self, local: FloatArray) -> FloatArray | None:
        """Return a value (k, ...) of all interfaces on rank 0, None elsewhere. Collective."""
        parcels = self.comm.gather(local)
        if self.mesh is None or parcels is None or self._interfaces is None:
            return None
        result = np.empty((self.mesh.interface_count, *local.shape[1:]))
        for numbers, values in zip(self._interfaces, parcels, strict=True):
            result[numbers] = values
        return result

    def scatter(self, values: FloatArray | None) -> FloatArray:
        """Return this rank's values of all interfaces given on rank 0, read-only. Collective."""
        parcels = None
        if values is not None and self._interfaces is not None:
            parcels = [values[numbers] for numbers in self._interfaces]
        received: FloatArray = read_only(self.comm.scatter(parcels))
        return received

    def gather_elements(self, local: FloatArray) -> FloatArray | None:
        """Return a value of all elements on rank 0, None elsewhere. Collective.

        Args:
            local: Of owned elements, or of these and the ghosts; (owned, ...).
        """
        parcels = self.comm.gather(local[: self.subdomain.owned_count])
        return None if parcels is None else np.concatenate(parcels)

    def scatter_elements(self, values: FloatArray | None) -> FloatArray:
        """Return a value of owned elements from that of all given on rank 0; (owned, ...). Collective."""
        everywhere: FloatArray = self.comm.bcast(values)
        return everywhere[self.subdomain.owned_elements]

    def motions(self) -> FloatArray | None:
        """Return (X, Y, theta) of all elements on rank 0 [um, um, rad]; (n, 3). Collective."""
        unknowns = self.equilibrium.system.unknowns()
        return self.gather_elements(unknowns / np.array([1.0, 1.0, self.subdomain.rotation_length]))

    def edges(self, chosen: IntArray) -> "Edges":
        """Return interfaces that any rank names as all ranks see them, by ascending number.

        Args:
            chosen: Local numbers on this rank; those of other owners are passed over.
        """
        interfaces = self.subdomain.interfaces
        mine = chosen[self.subdomain.owns_interface[chosen]]
        pairs = self.subdomain.element_numbers[interfaces.elements[mine]]
        parcel = (
            interfaces.numbers[mine],
            pairs,
            interfaces.junctions[mine],
            interfaces.ends[mine],
        )
        if self.comm.size == 1:
            return Edges(*parcel)
        parcels = self.comm.allgather(parcel)
        whole = [np.concatenate(arrays) for arrays in zip(*parcels, strict=True)]
        order = np.argsort(whole[0])
        return Edges(*(array[order] for array in whole))

    def local(self, edges: "Edges") -> IntArray:
        """Return the local numbers of those interfaces that this rank has."""
        return local_interfaces(self.subdomain, edges.numbers)[1]


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """Interfaces as edges between junctions of the mesh, the same on all ranks.

    Attributes:
        numbers: In the whole mesh; (b,).
        elements: On both sides; (b, 2).
        junctions: At both ends; (b, 2).
        ends: Where those are [um]; (b, 2, 2).
    """

    numbers: IntArray
    elements: IntArray
    junctions: IntArray
    ends: FloatArray


def _distribute(comm: MPI.Comm, scene: Scene, mesh: Mesh | None, ratio: float | None) -> Subdomain:
    subdomains = on_first_rank(comm, lambda: _subdomains(comm.size, scene, mesh, ratio))
    if comm.size == 1 and subdomains is not None:
        return subdomains[0]
    received: Subdomain = comm.scatter(subdomains)
    # Not every protocol of pickle keeps arrays read-only.
    return replace(
        received, interfaces=replace(received.interfaces), boundary=replace(received.boundary)
    )


def _subdomains(
    count: int, scene: Scene, mesh: Mesh | None, ratio: float | None
) -> list[Subdomain]:
    assert mesh is not None
    stiffness = spring_stiffness(mesh, scene.material, ratio)
    return [
        subdomain_of(mesh, stiffness, *ends) for ends in element_ranges(mesh.element_count, count)
    ]
