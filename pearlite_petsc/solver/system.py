"""The equations K x = f of a mesh on the ranks of a group, at a damage that moves on."""

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, read_only
from pearlite_petsc.mechanics.kinematics import jumps
from pearlite_petsc.solver.closing import Closing
from pearlite_petsc.solver.ghosts import GhostExchange
from pearlite_petsc.solver.krylov import stage
from pearlite_petsc.solver.matrix import StiffnessMatrix
from pearlite_petsc.solver.part import Part


class LinearSystem(Closing):
    """Matrix, load and last solution. Collective; close it.

    Attributes:
        comm: The ranks.
        part: This rank's share of the mesh.
        operator: B of its interfaces; (k, 3, 6).
        damage: Of its interfaces, read-only; (k,).
        matrix: K of that damage.
        x, b: Solution and load; 3 own unknowns an element.
        ghosts: Brings the unknowns of the ghosts.

    Args:
        comm, part: As above.
        damage: At the start, from now on read-only; (k,).
    """

    def __init__(self, comm: MPI.Comm, part: Part, damage: FloatArray) -> None:
        self.comm, self.part = comm, part
        self.operator = part.jump_operator()
        self.damage: FloatArray = read_only(damage)
        with stage("assemble"):
            self.matrix = StiffnessMatrix(comm, part, self.operator, damage)
        self.x, self.b = self.matrix.mat.createVecs()
        self.ghosts = GhostExchange(self.x, part)

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        self.ghosts.close()
        self.x.destroy()
        self.b.destroy()
        self.matrix.close()

    def update(self, damage: FloatArray) -> None:
        """Give the matrix a new damage. Collective.

        Args:
            damage: Of this rank's interfaces, from now on read-only; (k,).
        """
        self.damage = read_only(damage)
        with stage("assemble"):
            self.matrix.update(damage)

    def has_damage(self, damage: FloatArray) -> bool:
        """Return whether the matrix is that of a damage (k,) on all ranks. Collective."""
        same = np.array_equal(damage, self.damage)
        return bool(self.comm.allreduce(same, MPI.LAND))

    def set_load(self, load: FloatArray) -> None:
        """Give the right-hand side.

        Args:
            load: (F_x, F_y, M) on own elements [uN, uN, uN um]; (own, 3).
        """
        self.b.setArray(self.part.right_hand_side(load))

    def start_from(self, unknowns: FloatArray) -> None:
        """Give the unknowns that the next solve starts from; (own, 3) or more."""
        self.x.setArray(unknowns[: self.part.own].ravel())

    def solution(self) -> FloatArray:
        """Return a copy of the last solution on own elements [um]; (own, 3)."""
        return np.array(self.x.getArray(readonly=True).reshape(-1, 3))

    def unknowns(self) -> FloatArray:
        """Return the last solution on own elements and ghosts [um]; (own + g, 3). Collective."""
        return self.ghosts.values(self.x)

    def jumps(self, unknowns: FloatArray) -> FloatArray:
        """Return (normal, tangential, rotational) jump of each interface of the part; (k, 3)."""
        i, j = self.part.pairs.T
        return jumps(self.operator, unknowns[i], unknowns[j])

    def relative_residual(self) -> float:
        """Return |f - K x| / |f| of the last solution. Collective."""
        residual = self.b.duplicate()
        self.matrix.mat.mult(self.x, residual)
        residual.axpy(-1.0, self.b)
        relative = residual.norm() / max(self.b.norm(), np.finfo(float).tiny)
        residual.destroy()
        return float(relative)
