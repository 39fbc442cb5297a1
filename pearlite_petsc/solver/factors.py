"""Factors of the matrix at one damage: right-hand sides are solved for while the matrix moves on."""

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.solver.closing import Closing
from pearlite_petsc.solver.ghosts import GhostExchange
from pearlite_petsc.solver.petsc import PETSc
from pearlite_petsc.solver.woodbury import Woodbury

TYPES = PETSc.PC.Type.CHOLESKY, PETSc.PC.Type.LU


class Factors(Closing):
    """Solves with the matrix of one damage. Collective; closed by the equilibrium that made it.

    Attributes:
        number: Among all factors and preconditioners of an equilibrium, from 1.
        damage: That they were made for; (k,).
        are_preconditioner: Whether they are also the preconditioner of the equilibrium's solves.
        woodbury: Corrects that preconditioner for what has softened since; None does not.

    Args:
        number, damage, are_preconditioner: As above.
        pc: The factors; closed with this.
        ghosts: Brings the unknowns of the ghosts.
    """

    def __init__(
        self,
        number: int,
        damage: FloatArray,
        pc: PETSc.PC,
        ghosts: GhostExchange,
        are_preconditioner: bool,
    ) -> None:
        self.number, self.damage, self.are_preconditioner = number, damage, are_preconditioner
        self.woodbury: Woodbury | None = None
        self._pc, self._ghosts = pc, ghosts
        self._x, self._b = pc.getOperators()[0].createVecs()

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        self._x.destroy()
        self._b.destroy()
        self._pc.destroy()

    def solve(self, right_hand_side: FloatArray) -> FloatArray:
        """Return the unknowns of owned elements and ghosts; (owned + g, 3). Collective.

        Args:
            right_hand_side: In the units of the unknowns; (3 owned,).
        """
        self._b.setArray(right_hand_side)
        self._pc.apply(self._b, self._x)
        return self._ghosts.values(self._x)

    def solve_triples(
        self, triple: IntArray, unknowns: IntArray, values: FloatArray, count: int
    ) -> FloatArray:
        """Return the unknowns under triples of loads on a few unknowns each. Collective.

        Args:
            triple: Which one of them this rank gives, the others give the others; (m,).
            unknowns: Global numbers of the loaded ones of each; (m, 6).
            values: Their three loads; (m, 3, 6).
            count: Triples of all ranks.

        Returns:
            Shape (owned + g, 3, 3 count).
        """
        if self._b.comm.size == 1 and self._pc.getType() in TYPES:
            return self._solve_at_once(triple, unknowns, values, count)
        found = []
        for number, component in np.ndindex(count, 3):
            self._b.set(0.0)
            for mine in np.flatnonzero(triple == number):
                rows = unknowns[mine].astype(PETSc.IntType)
                self._b.setValues(rows, values[mine, component])
            self._b.assemble()
            self._pc.apply(self._b, self._x)
            found.append(self._ghosts.values(self._x))
        return np.stack(found, axis=2)

    def _solve_at_once(
        self, triple: IntArray, unknowns: IntArray, values: FloatArray, count: int
    ) -> FloatArray:
        shape = self._b.getSize(), 3 * count
        load, found = (PETSc.Mat().createDense(shape, comm=self._b.comm) for _ in range(2))
        load.setUp()
        found.setUp()
        column = 3 * triple[:, None] + np.arange(3)
        load.getDenseArray()[unknowns[:, None], column[:, :, None]] = values
        load.assemble()
        found.assemble()
        self._pc.getFactorMatrix().matSolve(load, found)
        solved = found.getDenseArray().copy(order="F")
        load.destroy()
        found.destroy()
        return np.asarray(solved.reshape(-1, 3, 3 * count))
