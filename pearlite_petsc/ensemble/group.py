"""A group of ranks that works on one task at a time, and how it agrees on errors."""

import logging
import sys
import traceback
from collections.abc import Callable
from time import monotonic, sleep
from typing import Any, TypeVar

from mpi4py import MPI

from pearlite_petsc.launch.display import say

T = TypeVar("T")

_log = logging.getLogger(__name__)

AGREEMENT_SECONDS = 30.0
"""How long the ranks of a group may take to learn of a common failure."""


class Group:
    """Ranks of one task. Made and closed by all ranks of the world together.

    Args:
        world: All ranks.
        size: Ranks of a group; ranks that are left over form no group.

    Attributes:
        comm: The group's communicator, the null communicator on ranks left over.
        count: Number of groups.
    """

    def __init__(self, world: MPI.Comm, size: int) -> None:
        self.count = world.size // size
        number = world.rank // size
        color = number if number < self.count else MPI.UNDEFINED
        self.comm = world.Split(color, world.rank)
        self._failures = self.comm.Dup() if self.comm != MPI.COMM_NULL and size > 1 else None

    def close(self) -> None:
        """Free the communicators. Collective."""
        if self._failures is not None:
            self._failures.Free()
        if self.comm != MPI.COMM_NULL:
            self.comm.Free()

    @property
    def has_ranks(self) -> bool:
        """Whether this rank belongs to a group at all."""
        return bool(self.comm != MPI.COMM_NULL)

    @property
    def first(self) -> bool:
        """Whether this rank is the group's first, the one that reads and writes."""
        return bool(self.comm.rank == 0)

    def any_of(self, bits: int) -> int:
        """Return the bits that any rank has set. Collective."""
        return self.comm.allreduce(bits, MPI.BOR) if self.comm.size > 1 else bits

    def same(self, value: T) -> T:
        """Return the first rank's value on all ranks. Collective."""
        return self.comm.bcast(value) if self.comm.size > 1 else value

    def agree_on_failure(self, error: Exception) -> None:
        """Return once every rank of the group has come here, too; else abort the job.

        An error on a part of the ranks leaves the others inside a collective call for ever: the
        group cannot go on, and nothing of it can be closed in order.
        """
        if self._failures is None:
            return
        arrived = self._failures.Ibarrier()
        end = monotonic() + AGREEMENT_SECONDS
        while not arrived.Test():
            if monotonic() > end:
                trace = "".join(traceback.format_exception(error))
                _log.critical("error on a part of the group's ranks: %s", trace)
                say(sys.stderr, f"error on a part of the group's ranks, aborting:\n{trace}")
                self.comm.Abort(1)
            sleep(0.001)


def wait_for_all(world: Any, meanwhile: Callable[[], object]) -> None:
    """Wait until every rank has come here; signals are seen and the processor is left to others.

    Args:
        world: All ranks.
        meanwhile: Called again and again while waiting.
    """
    arrived = world.Ibarrier()
    while not arrived.Test():
        meanwhile()
        sleep(0.01)
