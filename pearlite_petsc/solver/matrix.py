"""Distributed stiffness matrix (PETSc AIJ, block size 3) that follows the damage."""

import numpy as np
from mpi4py import MPI
from scipy.sparse import bsr_array

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.mechanics.kinematics import rigid_modes
from pearlite_petsc.solver.closing import Closing
from pearlite_petsc.solver.options import default_options
from pearlite_petsc.solver.petsc import PETSc
from pearlite_petsc.solver.subdomain import Subdomain

GROUNDING = 3e-14
"""Stiffness to ground of each unknown, as a fraction of its intact element's mean diagonal.

Above what rounding leaves of a loose cluster's rigid motions, and far below every load: all together
hold a body of 1e6 elements by 3e-8 of one diagonal, which lowers da/dN by 1e-6.
"""

SUPPORT = 1e-2
"""Stiffness of each of three supports, statically determinate, as a fraction of that diagonal.

Of a load in balance they carry nothing but the resultant of the grounding. Held by the grounding
alone, the rigid motions cost so little that a hierarchy must have them exactly; where GAMG drops
a coarse unknown that has no strong neighbours, CG goes up again by a factor of 1e2 and takes 20
to 40 more iterations.
"""

PLAIN_ROWS = {"mat_no_inode": "true"}
"""PETSc's products over groups of rows of one pattern take up to three times as long."""

_CHUNK = 4096
"""Interfaces at a time that stay in a core's cache."""


class StiffnessMatrix(Closing):
    """K = sum of B^T diag((1 - D) k) B over interfaces, grounding and supports. Collective.

    Every value is a function of the current damage alone: an update sums the blocks that the
    changed interfaces touch anew and inserts them, so that nothing drifts, an interface with D = 1
    adds exactly nothing, and a restarted run has the same matrix bit for bit.

    Attributes:
        mat: K of the current damage, with the rigid modes as near-null-space.
    """

    def __init__(
        self, comm: MPI.Comm, subdomain: Subdomain, operator: FloatArray, damage: FloatArray
    ) -> None:
        self._subdomain = subdomain
        self._intact = 1.0 - damage
        interfaces, own = subdomain.interfaces, subdomain.owned_count
        pairs = interfaces.elements
        numbers = subdomain.element_numbers
        # Half-edges: each interface seen from each of its owned elements.
        interface, side = np.nonzero(pairs < own)
        order = np.argsort(pairs[interface, side], kind="stable")
        self._interface, self._side = interface[order], side[order]
        row = pairs[self._interface, self._side]
        self._offsets = np.searchsorted(row, np.arange(own + 1))
        self._own_blocks, self._coupling = _intact_blocks(operator, interfaces.spring_constants())
        self._to_ground = self._ground(comm, row)
        blocks = np.concatenate([self._off_diagonal(slice(None)), self._diagonal(np.arange(own))])
        rows = np.concatenate([row, np.arange(own)])
        columns = np.concatenate([numbers[pairs[self._interface, 1 - self._side]], numbers[:own]])
        self._column = columns[: len(row)]
        self.mat = _assemble(comm, rows, columns, blocks, own, subdomain.element_count)
        self.mat.setOption(PETSc.Mat.Option.NEW_NONZERO_LOCATION_ERR, True)
        _declare_spd(self.mat)
        self._near_null_space = self._rigid_modes(comm)
        self.mat.setNearNullSpace(self._near_null_space)

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        self._near_null_space.destroy()
        self.mat.destroy()

    def update(self, damage: FloatArray) -> None:
        """Insert the values of a new damage where it differs from the current one. Collective.

        Args:
            damage: D of the subdomain's interfaces; shape (k,).
        """
        before, self._intact = self._intact, 1.0 - damage
        changed = before != self._intact
        pairs = self._subdomain.interfaces.elements
        touched = np.unique(pairs[changed])
        touched = touched[touched < self._subdomain.owned_count]
        half = np.flatnonzero(changed[self._interface])
        row = pairs[self._interface[half], self._side[half]]
        rows = np.concatenate([row, touched]) + self._subdomain.first_element
        columns = np.concatenate([self._column[half], touched + self._subdomain.first_element])
        if len(rows):
            values = np.concatenate([self._off_diagonal(half), self._diagonal(touched)])
            kind = PETSc.IntType
            self.mat.setValuesBlockedIJV(
                np.arange(len(rows) + 1, dtype=kind),
                columns.astype(kind),
                values,
                addv=PETSc.InsertMode.INSERT_VALUES,
                rowmap=rows.astype(kind),
            )
        self.mat.assemble()
        _declare_spd(self.mat)

    def _off_diagonal(self, half: IntArray | slice) -> FloatArray:
        """Return the blocks that couple half-edges' elements to their neighbours; (h, 3, 3)."""
        interface, side = self._interface[half], self._side[half]
        blocks: FloatArray = self._coupling[interface]
        second = side == 1
        blocks[second] = blocks[second].swapaxes(1, 2)
        blocks *= self._intact[interface, None, None]
        return blocks

    def _diagonal(self, elements: IntArray) -> FloatArray:
        """Sum each element's half-edges in their fixed order; shape (e, 3, 3)."""
        count = self._offsets[elements + 1] - self._offsets[elements]
        starts = np.cumsum(count) - count
        half = np.repeat(self._offsets[elements] - starts, count) + np.arange(count.sum())
        interface = self._interface[half]
        blocks = self._own_blocks[interface, self._side[half]]
        blocks *= self._intact[interface, None, None]
        diagonal = np.add.reduceat(blocks, starts) if len(elements) else np.zeros((0, 3, 3))
        diagonal[:, range(3), range(3)] += self._to_ground[elements]
        return np.asarray(diagonal)

    def _ground(self, comm: MPI.Comm, row: IntArray) -> FloatArray:
        """Return each owned unknown's stiffness to ground; (owned, 3). Collective.

        Args:
            row: Own element of each half-edge.
        """
        subdomain = self._subdomain
        fraction = np.full((subdomain.owned_count, 3), GROUNDING)
        x, y = subdomain.centre[: subdomain.owned_count].T
        # Lower left and lower right: a crack from the side comes there last.
        (_, left, *here), (_, right, *there) = (
            self._lowest(comm, score) for score in (x + y, y - x)
        )
        across = 0 if abs(here[1] - there[1]) > abs(here[0] - there[0]) else 1
        for element, component in ((left, 0), (left, 1), (right, across)):
            if subdomain.first_element <= element < subdomain.first_element + subdomain.owned_count:
                fraction[element - subdomain.first_element, component] += SUPPORT
        trace = np.trace(self._own_blocks, axis1=2, axis2=3)[self._interface, self._side]
        diagonal = np.bincount(row, trace, subdomain.owned_count) / 3.0
        return np.asarray(fraction * diagonal[:, None])

    def _lowest(self, comm: MPI.Comm, score: FloatArray) -> tuple[float, int, float, float]:
        """Return least score of all elements, its element's number and centre. Collective."""
        found = (np.inf, self._subdomain.element_count, 0.0, 0.0)
        if len(score):
            here = int(np.argmin(score))
            x, y = self._subdomain.centre[here].tolist()
            found = (float(score[here]), self._subdomain.first_element + here, x, y)
        lowest: tuple[float, int, float, float] = min(comm.allgather(found))
        return lowest

    def _rigid_modes(self, comm: MPI.Comm) -> PETSc.NullSpace:
        subdomain = self._subdomain
        centre = (
            comm.allreduce(subdomain.centre[: subdomain.owned_count].sum(axis=0))
            / subdomain.element_count
        )
        modes = rigid_modes(
            subdomain.centre[: subdomain.owned_count], subdomain.rotation_length, centre
        )
        vectors: list[PETSc.Vec] = []
        for mode in range(3):
            vector = self.mat.createVecRight()
            vector.setArray(modes[:, :, mode].ravel())
            for other in vectors:
                vector.axpy(-vector.dot(other), other)
            vector.normalize()
            vectors.append(vector)
        space = PETSc.NullSpace().create(vectors=vectors, comm=comm)
        for vector in vectors:
            vector.destroy()
        return space


def _intact_blocks(operator: FloatArray, constants: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return B_i^T k B_i and B_j^T k B_j (k, 2, 3, 3), and B_i^T k B_j (k, 3, 3), without damage."""
    sides = operator.reshape(-1, 3, 2, 3)
    own, coupling = np.empty((len(sides), 2, 3, 3)), np.empty((len(sides), 3, 3))
    for start in range(0, len(sides), _CHUNK):
        chunk = slice(start, start + _CHUNK)
        rows = sides[chunk]
        forces = constants[chunk, :, None, None] * rows
        for side in range(2):
            own[chunk, side] = _products(rows[:, :, side], forces[:, :, side])
        coupling[chunk] = _products(rows[:, :, 0], forces[:, :, 1])
    return own, coupling


def _products(left: FloatArray, right: FloatArray) -> FloatArray:
    """Return left^T right of each; shapes (h, 3, 3).

    Neither a matrix product nor a sum over an axis: how those round depends on how many there are
    and how they lie, and a restarted run must have the same bits.
    """
    terms = left[:, :, :, None] * right[:, :, None, :]
    return np.asarray(terms[:, 0] + terms[:, 1] + terms[:, 2])


def _assemble(
    comm: MPI.Comm, rows: IntArray, columns: IntArray, blocks: FloatArray, own: int, total: int
) -> PETSc.Mat:
    """Return the AIJ matrix of 3 x 3 blocks given in any order, each place once. Collective."""
    order = np.lexsort([columns, rows])
    offsets = np.searchsorted(rows[order], np.arange(own + 1))
    by_block = bsr_array((blocks[order], columns[order], offsets), shape=(3 * own, 3 * total))
    by_value = by_block.tocsr()
    kind = PETSc.IntType
    csr = (by_value.indptr.astype(kind), by_value.indices.astype(kind), by_value.data)
    size = (3 * own, 3 * total)
    with default_options(PLAIN_ROWS):
        return PETSc.Mat().createAIJ((size, size), bsize=3, csr=csr, comm=comm)


def _declare_spd(mat: PETSc.Mat) -> None:
    """Tell PETSc, which forgets it with every new value, that the matrix is SPD."""
    mat.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    mat.setOption(PETSc.Mat.Option.SPD, True)
