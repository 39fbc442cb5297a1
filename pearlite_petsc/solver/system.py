"""The equations K x = f of a mesh on the ranks of a group, at a damage that moves on."""

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, read_only
from pearlite_petsc.mechanics.kinematics import jumps
from pearlite_petsc.solver.closing import Closing
from pearlite_petsc.solver.ghosts import GhostExchange
from pearlite_petsc.solver.krylov import stage
from pearlite_petsc.solver.matrix import StiffnessMatrix
from pearlite_petsc.solver.subdomain import Subdomain


class LinearSystem(Closing):
    """Matrix, load and last solution. Collective; close it.

    Attributes:
        comm: The ranks.
        subdomain: What this rank knows of the mesh.
        operator: B of its interfaces; (k, 3, 6).
        damage: Of its interfaces, read-only; (k,).
        matrix: K of that damage.
        x, b: Solution and load; 3 unknowns an owned element.
        ghosts: Brings the unknowns of the ghosts.

    Args:
        comm, subdomain: As above.
        damage: At the start, from now on read-only; (k,).
    """

    def __init__(self, comm: MPI.Comm, subdomain: Subdomain, damage: FloatArray) -> None:
        self.comm, self.subdomain = comm, subdomain
        self.operator = subdomain.jump_operator()
        self.damage: FloatArray = read_only(damage)
        with stage("assemble"):
            self.matrix = StiffnessMatrix(comm, subdomain, self.operator, damage)
        self.x, self.b = self.matrix.mat.createVecs()
        self.ghosts = GhostExchange(self.x, subdomain)

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
            load: (F_x, F_y, M) on owned elements [uN, uN, uN um]; (owned, 3).
        """
        self.b.setArray(self.subdomain.right_hand_side(load))

    def start_from(self, unknowns: FloatArray) -> None:
        """Give the unknowns that the next solve starts from; (owned, 3) or more."""
        self.x.setArray(unknowns[: self.subdomain.owned_count].ravel())

    def solution(self) -> FloatArray:
        """Return a copy of the last solution on owned elements [um]; (owned, 3)."""
        return np.array(self.x.getArray(readonly=True).reshape(-1, 3))

    def unknowns(self) -> FloatArray:
        """Return the last solution on owned elements and ghosts [um]; (owned + g, 3). Collective."""
        return self.ghosts.values(self.x)

    def jumps(self, unknowns: FloatArray) -> FloatArray:
        """Return (normal, tangential, rotational) jump of each interface of the subdomain; (k, 3)."""
        i, j = self.subdomain.interfaces.elements.T
        return jumps(self.operator, unknowns[i], unknowns[j])

    def relative_residual(self) -> float:
        """Return |f - K x| / |f| of the last solution. Collective."""
        residual = self.b.duplicate()
        self.matrix.mat.mult(self.x, residual)
        residual.axpy(-1.0, self.b)
        relative = residual.norm() / max(self.b.norm(), np.finfo(float).tiny)
        residual.destroy()
        return float(relative)
