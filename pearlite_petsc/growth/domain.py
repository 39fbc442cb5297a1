"""One mesh on the ranks of a group: parts, matrix, damage law, and what travels between ranks."""

from collections.abc import Mapping

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.damage import damage_interfaces
from pearlite_petsc.growth.first_rank import on_first
from pearlite_petsc.laws.damage import RateConstants
from pearlite_petsc.mechanics.lefm import remote_stress
from pearlite_petsc.mechanics.loads import element_forces, uniform_stress, williams_mode_one
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.scene import Kind, Scene, State
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.part import Part, element_ranges, make_part
from pearlite_petsc.tessellation.mesh import Mesh


class Domain:
    """A mesh, its equilibrium and its damage law on this rank's share. Collective.

    Args:
        comm: The group.
        scene: The scene.
        mesh: The mesh on rank 0, None elsewhere.
        ratio: k_t/k_n of ``matched`` springs.
        damage: D of all interfaces on rank 0; None is an intact mesh with its notch.
        failure_cycles: Likewise.
        keep_first: Whether ``restart`` will be wanted.

    Attributes:
        damage: D of this rank's interfaces; (k,).
        failure_cycles: N at which they broke, NaN before, 0 the notch's; (k,).
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
        self.part = _distribute(comm, scene, mesh, ratio)
        self._shares = comm.gather(self.part.interface)
        if mesh is not None:
            notch = mesh.kind == Kind.NOTCH
            if damage is None:
                damage = notch.astype(float)
            if failure_cycles is None:
                failure_cycles = np.where(notch, 0.0, np.nan)
        self.damage = self.scatter(damage)
        self.failure_cycles = self.scatter(failure_cycles)
        self._start = self.damage, self.failure_cycles.copy()
        self.equilibrium = Equilibrium(comm, self.part, self.damage, scene.solver, keep_first)

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        self.equilibrium.close()

    def restart(self) -> None:
        """Go back to the damage and preconditioner of the start. Collective."""
        self.damage, self.failure_cycles = self._start[0], self._start[1].copy()
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
        part = self.part
        damage = self.scene.damage
        interfaces = damage_interfaces(
            part.length,
            part.kind,
            damage,
            state,
            threshold,
            part.midpoint,
            part.normal,
            crack_distance,
        )
        return damage.law.rate_constants(interfaces, damage).only(part.fine)

    def load(self, delta_k: float, tip: tuple[float, float]) -> FloatArray:
        """Return (F_x, F_y, M) on own elements for the crack's tip [uN, uN, uN um]; (own, 3)."""
        part, loading, width = self.part, self.scene.loading, self.scene.window.width
        if loading.kind == "k_field":
            airy = williams_mode_one(delta_k, tip)
        else:
            length = self.scene.window.notch if loading.control == "stress" else tip[0]
            airy = uniform_stress(0.0, remote_stress(delta_k, length, width), 0.0)
        own = part.centre[: part.own]
        return element_forces(part.facet_start, part.facet_end, part.facet, own, airy)

    def stresses(self, jump: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return effective normal and shear stress k_0 jump [MPa], broken or not; (k,) each."""
        springs = self.part.stiffness
        return springs.k_n * jump[:, 0], springs.k_t * jump[:, 1]

    def gather(self, local: FloatArray) -> FloatArray | None:
        """Return a value of all interfaces on rank 0, None elsewhere. Collective."""
        shares = self.comm.gather(local)
        if self.mesh is None or shares is None or self._shares is None:
            return None
        result = np.empty((self.mesh.interface_count, *local.shape[1:]))
        for numbers, share in zip(self._shares, shares, strict=True):
            result[numbers] = share
        return result

    def gather_all(self, local: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Return values of all interfaces on rank 0, nothing elsewhere. Collective."""
        gathered = {name: self.gather(values) for name, values in local.items()}
        return {name: values for name, values in gathered.items() if values is not None}

    def gather_unknowns(self, unknowns: FloatArray) -> FloatArray | None:
        """Return (X, Y, theta) of all elements on rank 0, None elsewhere. Collective."""
        motion = unknowns[: self.part.own] / np.array([1.0, 1.0, self.part.rotation])
        shares = self.comm.gather(motion)
        return None if shares is None else np.concatenate(shares)

    def share_edges(self, chosen: IntArray) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
        """Return numbers, elements, junctions and ends of interfaces any rank names. Collective.

        Args:
            chosen: Local numbers on this rank; those of other owners are passed over.
        """
        part = self.part
        mine = chosen[part.owned[chosen]]
        pairs = part.numbers[part.pairs[mine]]
        parcel = (part.interface[mine], pairs, part.junctions[mine], part.ends[mine])
        if self.comm.size == 1:
            return parcel
        parcels = self.comm.allgather(parcel)
        numbers, pairs, junctions, ends = map(np.concatenate, zip(*parcels, strict=True))
        order = np.argsort(numbers)
        return numbers[order], pairs[order], junctions[order], ends[order]

    @property
    def own(self) -> slice:
        """Own elements among all."""
        return slice(self.part.first, self.part.first + self.part.own)

    def scatter(self, values: FloatArray | None) -> FloatArray:
        """Return this rank's share of a value of all interfaces given on rank 0. Collective."""
        shares = None
        if values is not None and self._shares is not None:
            shares = [values[numbers] for numbers in self._shares]
        share: FloatArray = self.comm.scatter(shares)
        return share


def _distribute(comm: MPI.Comm, scene: Scene, mesh: Mesh | None, ratio: float | None) -> Part:
    parts = on_first(comm, lambda: _parts(comm.size, scene, mesh, ratio))
    if comm.size == 1 and parts is not None:
        return parts[0]
    part: Part = comm.scatter(parts)
    return part


def _parts(count: int, scene: Scene, mesh: Mesh | None, ratio: float | None) -> list[Part]:
    assert mesh is not None
    stiffness = spring_stiffness(mesh, scene.material, ratio)
    return [make_part(mesh, stiffness, *ends) for ends in element_ranges(mesh.element_count, count)]
