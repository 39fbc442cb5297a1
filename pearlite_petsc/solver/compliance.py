"""Compliance of a few interfaces in the whole body, from factors kept while they soften."""

from collections.abc import Sequence

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.krylov import stage
from pearlite_petsc.solver.petsc import PETSc


class Compliance:
    """Jumps of chosen interfaces to pairs of unit forces on each other. Collective; close it.

    The factors are those of one damage. Each interface that is taken costs three
    back-substitutions once; how far it and the others have softened since enters by the
    Sherman-Morrison-Woodbury formula, so that no later damage needs new factors.

    Attributes:
        set_up_damage: Damage that the factors were made for; (k,).
        taken: Global numbers of the interfaces in the order in which they were taken; (s,).

    Args:
        comm: The ranks.
        equilibrium: Holds the matrix, whose values must be those of the damage.
        damage: Of the part's interfaces, not changed afterwards; (k,).
    """

    def __init__(self, comm: MPI.Comm, equilibrium: Equilibrium, damage: FloatArray) -> None:
        self._comm, self._equilibrium = comm, equilibrium
        self.part = equilibrium.part
        self.set_up_damage = damage
        self._factors = equilibrium.factors()
        self._x, self._b = equilibrium.mat.createVecs()
        self._constants = self.part.spring_constants()
        self.forget()

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        self._factors.destroy()
        self._x.destroy()
        self._b.destroy()

    def forget(self) -> None:
        """Forget the interfaces taken and keep the factors."""
        self.taken = np.empty(0, dtype=np.int64)
        self._local = np.empty(0, dtype=np.int64)
        self._springs = np.empty((0, 3))
        self._set_up = np.empty((0, 0))

    def take(self, numbers: IntArray) -> None:
        """Take more interfaces, those taken before left out. Collective.

        Args:
            numbers: Global ones, the same on all ranks.
        """
        new = numbers[~np.isin(numbers, self.taken)]
        if not len(new):
            return
        self._equilibrium.counters["unit_loads"] += 3 * len(new)
        before = 3 * len(self.taken)
        self.taken = np.concatenate([self.taken, new])
        self._local = self._own_places(self.taken)
        self._springs = self._shared(self._constants)
        mine = self._local[self._local >= 0]
        self._rows = self._equilibrium.operator[mine]
        self._pairs = self.part.pairs[mine]
        grown = np.zeros((3 * len(self.taken),) * 2)
        grown[:before, :before] = self._set_up
        for column in range(before, len(grown)):
            with stage("solve"):
                self._put_unit_pair(*divmod(column, 3))
                jumps = self._jumps_of_taken().ravel()
            # Maxwell and Betti: what those taken later do to this one need not be solved for. So
            # filled, the values do not depend on how many are taken at a time.
            end = 3 * (column // 3 + 1)
            grown[:end, column] = jumps[:end]
            grown[column, : end - 3] = jumps[: end - 3]
        self._set_up = grown

    def response(self, loads: Sequence[FloatArray]) -> FloatArray:
        """Return the jumps of the part's interfaces under loads, at the set-up damage. Collective.

        Args:
            loads: (F_x, F_y, M) on own elements [uN, uN, uN um]; (own, 3) each.

        Returns:
            Shape (k, 3, loads).
        """
        found = []
        for load in loads:
            scaled = load.copy()
            scaled[:, 2] /= self.part.rotation
            self._b.setArray(scaled.ravel())
            with stage("solve"):
                self._factors.apply(self._b, self._x)
                found.append(self._equilibrium.jumps(self._equilibrium.values(self._x)))
        return np.stack(found, axis=2)

    def now(
        self, numbers: IntArray, damage: FloatArray, response: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the compliance of interfaces taken, and a response, at another damage. Collective.

        Args:
            numbers: Global ones, all taken, the same on all ranks; (a,).
            damage: Of the part's interfaces; (k,).
            response: What ``response`` returned; (k, 3, l).

        Returns:
            C (3 a, 3 a) and the response of those interfaces (a, 3, l).
        """
        let_go = self._springs * self._shared(damage - self.set_up_damage)[:, None]
        chosen = np.flatnonzero(np.isin(self.taken, numbers))
        chosen = chosen[np.argsort(self.taken[chosen])]
        rows = (3 * chosen[:, None] + np.arange(3)).ravel()
        given = self._shared(response).reshape(len(let_go) * 3, -1)
        system = np.eye(len(self._set_up)) - self._set_up * let_go.ravel()
        found = np.linalg.solve(system, np.concatenate([self._set_up[:, rows], given], axis=1))
        compliance = found[rows, : len(rows)]
        return compliance, found[rows, len(rows) :].reshape(len(chosen), 3, -1)

    def _own_places(self, numbers: IntArray) -> IntArray:
        """Return the local numbers of interfaces on the rank that owns them, -1 elsewhere."""
        part = self.part
        place = np.searchsorted(part.interface, numbers)
        place = np.minimum(place, len(part.interface) - 1)
        mine = (part.interface[place] == numbers) & (part.pairs[place, 0] < part.own)
        return np.where(mine, place, -1)

    def _shared(self, local: FloatArray) -> FloatArray:
        """Return a value of the interfaces taken on all ranks, each from its owner. Collective."""
        mine = self._local >= 0
        values = np.zeros((len(self._local), *local.shape[1:]))
        values[mine] = local[self._local[mine]]
        if self._comm.size > 1:
            self._comm.Allreduce(MPI.IN_PLACE, values)
        return values

    def _put_unit_pair(self, interface: int, component: int) -> None:
        """Load the elements of an interface taken by a unit pair that opens one of its jumps."""
        self._b.set(0.0)
        local = self._local[interface]
        if local >= 0:
            elements = self.part.numbers[self.part.pairs[local]]
            rows = (3 * elements[:, None] + np.arange(3)).ravel()
            rows = rows.astype(PETSc.IntType)
            self._b.setValues(rows, self._equilibrium.operator[local, component])
        self._b.assemble()

    def _jumps_of_taken(self) -> FloatArray:
        """Return the jumps of the interfaces taken under the load put, on all ranks; (s, 3)."""
        self._factors.apply(self._b, self._x)
        unknowns = self._equilibrium.values(self._x)[self._pairs].reshape(-1, 6, 1)
        found = np.zeros((len(self._local), 3))
        found[self._local >= 0] = (self._rows @ unknowns)[:, :, 0]
        if self._comm.size > 1:
            self._comm.Allreduce(MPI.IN_PLACE, found)
        return found
