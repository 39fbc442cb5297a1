"""One mesh on the ranks of a group: subdomains, matrix, damage law, and what travels between ranks."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, IntArray, read_only
from pearlite_petsc.fatigue.damage import damage_interfaces
from pearlite_petsc.growth.first_rank import on_first
from pearlite_petsc.laws.damage import RateConstants
from pearlite_petsc.mechanics.lefm import remote_stress
from pearlite_petsc.mechanics.loads import element_forces, uniform_stress, williams_mode_one
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.scene import Kind, Scene, State
from pearlite_petsc.solver.closing import Closing
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.subdomain import Subdomain, element_ranges, subdomain_of
from pearlite_petsc.tessellation.mesh import Mesh


class Domain(Closing):
    """A mesh, its equilibrium and its damage law on this rank's subdomain. Collective; close it.

    Args:
        comm: The group.
        scene: The scene.
        mesh: The mesh on rank 0, None elsewhere.
        ratio: k_t/k_n of ``matched`` springs.
        damage: D of all interfaces on rank 0; None is an intact mesh with its notch.
        failure_cycles: Likewise.
        keep_first: Whether ``restart`` will be wanted.

    Attributes:
        subdomain: This rank's.
        equilibrium: Of its elements.
        damage: D of this rank's interfaces, read-only; (k,).
        failure_cycles: N at which they broke, NaN before, 0 the notch's; read-only; (k,).
    """

    def __init__(
        self,
        comm: MPI.Comm,
        scene: Scene,
        mesh: Mesh | None,
        ratio: float | None,
        damage: FloatArray | None = None,
        failure_cycles: FloatArray | None = None,
        keep_first: bool = False,
    ) -> None:
        self.comm, self.scene, self.mesh = comm, scene, mesh
        self.subdomain = _distribute(comm, scene, mesh, ratio)
        self._numbers = comm.gather(self.subdomain.interface_numbers)
        if mesh is not None:
            notch = mesh.kind == Kind.NOTCH
            if damage is None:
                damage = notch.astype(float)
            if failure_cycles is None:
                failure_cycles = np.where(notch, 0.0, np.nan)
        self.damage = self.scatter(damage)
        self.failure_cycles = self.scatter(failure_cycles)
        self._start = self.damage, self.failure_cycles
        self.equilibrium = Equilibrium(comm, self.subdomain, self.damage, scene.solver, keep_first)

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        self.equilibrium.close()

    def restart(self) -> None:
        """Go back to the damage and preconditioner of the start. Collective."""
        self.damage, self.failure_cycles = self._start
        self.equilibrium.restart()

    def rate_constants(self, state: State, crack_distance: FloatArray | None) -> RateConstants:
        """Return what the damage law makes of this rank's interfaces.

        Args:
            state: State of the steel.
            crack_distance: Of each interface from the crack [um]; (k,), None where the law does
                not follow the crack.

        Coarse elements carry the load to the fine ones and take no damage: their long interfaces
        would pass a threshold that falls with 1/sqrt(L) far from any crack.
        """
        window = self.scene.window
        threshold = remote_stress(state.delta_k_th, window.notch, window.width)
        subdomain = self.subdomain
        damage = self.scene.damage
        interfaces = damage_interfaces(
            subdomain.length,
            subdomain.kind,
            damage,
            state,
            threshold,
            subdomain.midpoint,
            subdomain.normal,
            crack_distance,
            subdomain.cementite_share,
        )
        return damage.law.rate_constants(interfaces, damage).only(subdomain.fine)

    def load(self, delta_k: float, tip: tuple[float, float]) -> FloatArray:
        """Return (F_x, F_y, M) on owned elements for the crack's tip [uN, uN, uN um]; (owned, 3)."""
        subdomain, loading, width = self.subdomain, self.scene.loading, self.scene.window.width
        if loading.kind == "k_field":
            airy = williams_mode_one(delta_k, tip)
        else:
            length = self.scene.window.notch if loading.control == "stress" else tip[0]
            airy = uniform_stress(0.0, remote_stress(delta_k, length, width), 0.0)
        return element_forces(
            subdomain.facet_start,
            subdomain.facet_end,
            subdomain.boundary_elements,
            subdomain.centre[: subdomain.owned_count],
            airy,
        )

    def stresses(self, jump: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return effective normal and shear stress k_0 jump [MPa], broken or not; (k,) each."""
        springs = self.subdomain.stiffness
        return springs.k_n * jump[:, 0], springs.k_t * jump[:, 1]

    def gather(self, local: FloatArray) -> FloatArray | None:
        """Return a value of all interfaces on rank 0, None elsewhere. Collective."""
        parcels = self.comm.gather(local)
        if self.mesh is None or parcels is None or self._numbers is None:
            return None
        result = np.empty((self.mesh.interface_count, *local.shape[1:]))
        for numbers, values in zip(self._numbers, parcels, strict=True):
            result[numbers] = values
        return result

    def gather_all(self, local: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Return values of all interfaces on rank 0, nothing elsewhere. Collective."""
        gathered = {name: self.gather(values) for name, values in local.items()}
        return {name: values for name, values in gathered.items() if values is not None}

    def gather_unknowns(self, unknowns: FloatArray) -> FloatArray | None:
        """Return (X, Y, theta) of all elements on rank 0, None elsewhere. Collective."""
        motion = unknowns[: self.subdomain.owned_count] / np.array(
            [1.0, 1.0, self.subdomain.rotation_length]
        )
        parcels = self.comm.gather(motion)
        return None if parcels is None else np.concatenate(parcels)

    def share_edges(self, chosen: IntArray) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
        """Return numbers, elements, junctions and ends of interfaces any rank names. Collective.

        Args:
            chosen: Local numbers on this rank; those of other owners are passed over.
        """
        subdomain = self.subdomain
        mine = chosen[subdomain.owns_interface[chosen]]
        pairs = subdomain.element_numbers[subdomain.interface_elements[mine]]
        parcel = (
            subdomain.interface_numbers[mine],
            pairs,
            subdomain.junctions[mine],
            subdomain.ends[mine],
        )
        if self.comm.size == 1:
            return parcel
        parcels = self.comm.allgather(parcel)
        numbers, pairs, junctions, ends = map(np.concatenate, zip(*parcels, strict=True))
        order = np.argsort(numbers)
        return numbers[order], pairs[order], junctions[order], ends[order]

    def scatter(self, values: FloatArray | None) -> FloatArray:
        """Return this rank's values of all interfaces given on rank 0, read-only. Collective."""
        parcels = None
        if values is not None and self._numbers is not None:
            parcels = [values[numbers] for numbers in self._numbers]
        received: FloatArray = read_only(self.comm.scatter(parcels))
        return received


def _distribute(comm: MPI.Comm, scene: Scene, mesh: Mesh | None, ratio: float | None) -> Subdomain:
    subdomains = on_first(comm, lambda: _subdomains(comm.size, scene, mesh, ratio))
    if comm.size == 1 and subdomains is not None:
        return subdomains[0]
    received: Subdomain = comm.scatter(subdomains)
    # Arrays that were sent are writeable again.
    return replace(received)


def _subdomains(
    count: int, scene: Scene, mesh: Mesh | None, ratio: float | None
) -> list[Subdomain]:
    assert mesh is not None
    stiffness = spring_stiffness(mesh, scene.material, ratio)
    return [
        subdomain_of(mesh, stiffness, *ends) for ends in element_ranges(mesh.element_count, count)
    ]
