"""Values of a few interfaces on all ranks, each from the rank that owns it."""

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.solver.subdomain import Subdomain


def local_interfaces(subdomain: Subdomain, numbers: IntArray) -> tuple[IntArray, IntArray]:
    """Return which of some interfaces a rank has, and their local numbers.

    Args:
        subdomain: What the rank knows of the mesh.
        numbers: Global ones; (a,).
    """
    known = subdomain.interfaces.numbers
    place = np.minimum(np.searchsorted(known, numbers), len(known) - 1)
    row = np.flatnonzero(known[place] == numbers)
    return row, place[row]


def owned_interfaces(subdomain: Subdomain, numbers: IntArray) -> tuple[IntArray, IntArray]:
    """Return which of some interfaces a rank owns, and their local numbers.

    Args:
        subdomain: What the rank knows of the mesh.
        numbers: Global ones; (a,).
    """
    row, place = local_interfaces(subdomain, numbers)
    mine = subdomain.interfaces.elements[place, 0] < subdomain.owned_count
    return row[mine], place[mine]


def from_owners(
    comm: MPI.Comm, subdomain: Subdomain, numbers: IntArray, values: FloatArray
) -> FloatArray:
    """Return values of some interfaces on all ranks, each from its owner; (a, ...). Collective.

    Args:
        comm: The ranks.
        subdomain: What this rank knows of the mesh.
        numbers: Global ones, the same on all ranks; (a,).
        values: Of the subdomain's interfaces; (k, ...).
    """
    row, place = owned_interfaces(subdomain, numbers)
    found = np.zeros((len(numbers), *values.shape[1:]))
    found[row] = values[place]
    if comm.size > 1:
        comm.Allreduce(MPI.IN_PLACE, found)
    return found
