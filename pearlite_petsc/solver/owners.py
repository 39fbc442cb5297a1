"""Values of a few interfaces on all ranks, each from the rank that owns it."""

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.solver.part import Part


def places_here(part: Part, numbers: IntArray) -> tuple[IntArray, IntArray]:
    """Return which of some interfaces a rank has, and their local numbers.

    Args:
        part: The rank's share of the mesh.
        numbers: Global ones; (a,).
    """
    place = np.minimum(np.searchsorted(part.interface, numbers), len(part.interface) - 1)
    row = np.flatnonzero(part.interface[place] == numbers)
    return row, place[row]


def places_owned(part: Part, numbers: IntArray) -> tuple[IntArray, IntArray]:
    """Return which of some interfaces a rank owns, and their local numbers.

    Args:
        part: The rank's share of the mesh.
        numbers: Global ones; (a,).
    """
    row, place = places_here(part, numbers)
    mine = part.pairs[place, 0] < part.own
    return row[mine], place[mine]


def from_owners(comm: MPI.Comm, part: Part, numbers: IntArray, values: FloatArray) -> FloatArray:
    """Return values of some interfaces on all ranks, each from its owner; (a, ...). Collective.

    Args:
        comm: The ranks.
        part: This rank's share of the mesh.
        numbers: Global ones, the same on all ranks; (a,).
        values: Of the part's interfaces; (k, ...).
    """
    row, place = places_owned(part, numbers)
    found = np.zeros((len(numbers), *values.shape[1:]))
    found[row] = values[place]
    if comm.size > 1:
        comm.Allreduce(MPI.IN_PLACE, found)
    return found
