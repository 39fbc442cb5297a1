"""Work of a group's first rank alone, whose errors must not leave the others waiting."""

import pickle
from collections.abc import Callable
from typing import TypeVar

from mpi4py import MPI

from pearlite_petsc.errors import PearliteError

T = TypeVar("T")


def on_first_rank(comm: MPI.Comm, function: Callable[[], T], to_all: bool = False) -> T | None:
    """Call a function on rank 0; what it raises is raised on all ranks. Collective.

    Args:
        comm: The group.
        function: Not collective.
        to_all: Whether all ranks get the result; else the others get None.
    """
    result: T | None = None
    error: Exception | None = None
    if comm.rank == 0:
        try:
            result = function()
        except Exception as raised:
            error = raised
    if comm.size > 1:
        sent = comm.bcast(None if error is None else _sendable(error))
        error = error or sent
    if error is not None:
        raise error
    return comm.bcast(result) if to_all and comm.size > 1 else result


def _sendable(error: Exception) -> Exception:
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return PearliteError(f"{type(error).__name__}: {error}")
    return error
