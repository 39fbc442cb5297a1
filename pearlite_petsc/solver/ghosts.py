"""Values of a rank's owned elements and its ghosts, exchanged between neighbours by a scatter."""

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.solver.closing import Closing
from pearlite_petsc.solver.petsc import PETSc
from pearlite_petsc.solver.subdomain import Subdomain


class GhostExchange(Closing):
    """Brings the unknowns of the ghosts from their owners. Collective; close it when done.

    Args:
        vector: A vector of the unknowns.
        subdomain: What this rank knows of the mesh.
    """

    def __init__(self, vector: PETSc.Vec, subdomain: Subdomain) -> None:
        kind = PETSc.IntType
        source = PETSc.IS().createBlock(3, subdomain.ghosts.astype(kind), comm=PETSc.COMM_SELF)
        self._ghost = PETSc.Vec().createSeq(3 * len(subdomain.ghosts), bsize=3)
        target = PETSc.IS().createStride(self._ghost.getSize(), step=1, comm=PETSc.COMM_SELF)
        self._scatter = PETSc.Scatter().create(vector, source, self._ghost, target)
        source.destroy()
        target.destroy()

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        self._scatter.destroy()
        self._ghost.destroy()

    def values(self, vector: PETSc.Vec) -> FloatArray:
        """Return the unknowns of owned elements and ghosts; shape (owned + g, 3). Collective."""
        self._scatter.scatter(vector, self._ghost)
        own = vector.getArray(readonly=True)
        ghosts = self._ghost.getArray(readonly=True)
        return np.asarray(np.concatenate([own, ghosts]).reshape(-1, 3))
