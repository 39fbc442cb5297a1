"""Compliance of a few interfaces in the whole body, from factors kept while they soften."""

from collections.abc import Sequence

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.solver.corrected import Correction
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.krylov import stage
from pearlite_petsc.solver.owners import from_owners, places_owned
from pearlite_petsc.solver.petsc import PETSc

MOST_AT_ONCE = 4e6
"""Values of the right-hand sides that are solved for at once."""

_FACTORS = PETSc.PC.Type.CHOLESKY, PETSc.PC.Type.LU


class Compliance:
    """Jumps of chosen interfaces to pairs of unit forces on each other. Collective; close it.

    The factors are those of one damage. Each interface that is taken costs three
    back-substitutions once; how far it and the others have softened since enters by the
    Sherman-Morrison-Woodbury formula, so that no later damage needs new factors.

    Attributes:
        set_up_damage: Damage that the factors were made for; (k,).
        taken: Global numbers of the interfaces in the order in which they were taken; (s,).
        batch: With which others each of them was solved for, from 0; (s,).

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
        self._corrects = equilibrium.shares(self._factors)
        self._x, self._b = equilibrium.mat.createVecs()
        self._constants = self.part.spring_constants()
        self.forget()

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        self._factors.destroy()
        self._x.destroy()
        self._b.destroy()

    @property
    def is_outdated(self) -> bool:
        """Whether the equilibrium has made newer factors."""
        return self._corrects and not self._equilibrium.shares(self._factors)

    def forget(self) -> None:
        """Forget the interfaces taken and keep the factors."""
        self.taken = np.empty(0, dtype=np.int64)
        self._row: dict[int, int] = {}
        self.batch = np.empty(0, dtype=np.int64)
        self._springs = np.empty((0, 3))
        self._set_up = np.empty((0, 0))
        self._columns = np.empty((3 * self.part.own, 0), order="F")

    def take(self, numbers: IntArray) -> None:
        """Take more interfaces, those taken before left out. Collective.

        Args:
            numbers: Global ones, the same on all ranks.
        """
        new = np.array([n for n in numbers.tolist() if n not in self._row], dtype=np.int64)
        most = max(1, int(MOST_AT_ONCE / (9 * self.part.total)))
        for start in range(0, len(new), most):
            self._take(new[start : start + most])
        if len(new):
            self._equilibrium.correct(self._factors, self._correction)

    def _take(self, new: IntArray) -> None:
        self._equilibrium.counters["unit_loads"] += 3 * len(new)
        before = 3 * len(self.taken)
        number = self.batch[-1] + 1 if before else 0
        self.taken = np.concatenate([self.taken, new])
        self._row = {n: row for row, n in enumerate(self.taken.tolist())}
        self.batch = np.concatenate([self.batch, np.full(len(new), number)])
        self._springs = from_owners(self._comm, self.part, self.taken, self._constants)
        row, place = places_owned(self.part, self.taken)
        with stage("solve"):
            unknowns = self._under_unit_pairs(new)[self.part.pairs[place]]
        opened = np.zeros((len(self.taken), 3, 3 * len(new)))
        unknowns = unknowns.reshape(len(place), 6, 3 * len(new))
        opened[row] = self._equilibrium.operator[place] @ unknowns
        if self._comm.size > 1:
            self._comm.Allreduce(MPI.IN_PLACE, opened)
        grown = np.empty((3 * len(self.taken),) * 2)
        grown[:before, :before] = self._set_up
        grown[:, before:] = opened.reshape(len(grown), -1)
        # Maxwell and Betti: what those taken before do to the new ones need not be solved for.
        grown[before:, :before] = grown[:before, before:].T
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
            self._b.setArray(self.part.right_hand_side(load))
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
        let_go = self._let_go(damage)
        chosen = np.array([self._row[n] for n in numbers.tolist()], dtype=np.int64)
        rows = (3 * chosen[:, None] + np.arange(3)).ravel()
        given = from_owners(self._comm, self.part, self.taken, response)
        given = given.reshape(len(let_go), -1)
        system = np.eye(len(let_go)) - self._set_up * let_go
        found = np.linalg.solve(system, np.concatenate([self._set_up[:, rows], given], axis=1))
        compliance = found[rows, : len(rows)]
        return compliance, found[rows, len(rows) :].reshape(len(chosen), 3, -1)

    def _let_go(self, damage: FloatArray) -> FloatArray:
        """Return what the springs of those taken have lost since the set-up; (3 s,). Collective."""
        since = from_owners(self._comm, self.part, self.taken, damage - self.set_up_damage)
        return np.asarray((self._springs * since[:, None]).ravel())

    def _correction(self, damage: FloatArray) -> Correction | None:
        """Return what turns the factors into those of another damage of the interfaces taken."""
        let_go = self._let_go(damage)
        if not let_go.any():
            return None
        try:
            system = let_go[:, None] * np.linalg.inv(np.eye(len(let_go)) - self._set_up * let_go)
        except np.linalg.LinAlgError:
            # What hung on them alone is loose; the factors as they are go on.
            return None
        operator, unknown = self._rows_of(places_owned(self.part, self.taken)[1])

        def correction(solution: FloatArray) -> FloatArray:
            opened = operator @ solution[unknown][:, :, None]
            return np.asarray(self._columns @ (system @ opened.ravel()))

        return correction

    def _rows_of(self, place: IntArray) -> tuple[FloatArray, IntArray]:
        """Return B (a, 3, 6) of this rank's interfaces, and which unknowns it takes; (a, 6)."""
        elements = self.part.numbers[self.part.pairs[place]]
        unknown = (3 * elements[:, :, None] + np.arange(3)).reshape(-1, 6)
        return self._equilibrium.operator[place], unknown

    def _under_unit_pairs(self, numbers: IntArray) -> FloatArray:
        """Return the unknowns under unit pairs that open each jump of some interfaces. Collective.

        Shape (own + g, 3, 3 a).
        """
        row, place = places_owned(self.part, numbers)
        operator, unknown = self._rows_of(place)
        if self._comm.size == 1 and self._factors.getType() in _FACTORS:
            shape = 3 * self.part.own, 3 * len(numbers)
            load, found = (PETSc.Mat().createDense(shape, comm=self._comm) for _ in range(2))
            load.setUp()
            found.setUp()
            column = 3 * row[:, None] + np.arange(3)
            load.getDenseArray()[unknown[:, None], column[:, :, None]] = operator
            load.assemble()
            found.assemble()
            self._factors.getFactorMatrix().matSolve(load, found)
            unknowns = found.getDenseArray().copy(order="F")
            if self._corrects:
                self._columns = np.concatenate([self._columns, unknowns], axis=1)
            load.destroy()
            found.destroy()
            return np.asarray(unknowns.reshape(self.part.own, 3, -1))
        found = []
        for interface, component in np.ndindex(len(numbers), 3):
            self._b.set(0.0)
            for mine in np.flatnonzero(row == interface):
                rows = unknown[mine].astype(PETSc.IntType)
                self._b.setValues(rows, operator[mine, component])
            self._b.assemble()
            self._factors.apply(self._b, self._x)
            found.append(self._equilibrium.values(self._x))
        return np.stack(found, axis=2)
