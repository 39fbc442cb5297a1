"""The board: what every rank sees of all tasks, and where a group takes its next one.

It lives in the memory of rank 0 and is read and changed by one-sided calls, so no rank is lost to
supervising. On one node that is shared memory and needs nothing of rank 0; between nodes rank 0
may have to enter MPI for a call to get through, which ``tick`` sees to.
"""

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.ensemble.status import COLUMNS, Status


class Board:
    """Status and measured values of all tasks. Made and closed by all ranks together.

    Args:
        world: All ranks.
        status: Status of each task at the start, from rank 0; (n,).
        values: Measured values at the start, from rank 0; (n, columns).
    """

    def __init__(self, world: MPI.Comm, status: IntArray | None, values: FloatArray | None) -> None:
        self._count = count = world.bcast(None if status is None else len(status))
        self._world = world
        words = count + 1 + count * len(COLUMNS)
        # One rank needs no window, and not every MPI makes one for it.
        self._window = None
        if world.size > 1:
            size = 8 * words if world.rank == 0 else 0
            self._window = MPI.Win.Allocate(size, 8, comm=world)
        self._memory = np.zeros(words, dtype=np.int64)
        if world.rank == 0 and status is not None and values is not None:
            if self._window is not None:
                self._memory = np.frombuffer(self._window.tomemory(), dtype=np.int64)
            self._memory[:count] = status
            self._memory[count] = 0
            self._memory[count + 1 :] = values.ravel().view(np.int64)
        world.Barrier()
        if self._window is not None:
            self._window.Lock_all()

    def close(self) -> None:
        """Free the window. Collective."""
        if self._window is not None:
            self._window.Unlock_all()
            self._memory = np.zeros(0, dtype=np.int64)
            self._window.Free()
            self._window = None

    def tick(self) -> None:
        """Let one-sided calls of others through where they need this rank to enter MPI."""
        if self._window is not None:
            self._world.Iprobe(MPI.ANY_SOURCE, MPI.ANY_TAG)

    def status(self) -> IntArray:
        """Return the status of each task; (n,)."""
        return self._get(0, self._count)

    def values(self) -> FloatArray:
        """Return the measured values, meaningful for finished tasks; (n, columns)."""
        words = self._get(self._count + 1, self._count * len(COLUMNS))
        return words.view(np.float64).reshape(self._count, len(COLUMNS))

    def claim(self, task: int) -> bool:
        """Take a task if it is open; return whether it is now the caller's."""
        return self._swap(task, Status.OPEN, Status.RUNNING)

    def release(self, task: int) -> None:
        """Give a running task back."""
        self._swap(task, Status.RUNNING, Status.OPEN)

    def finish(self, task: int, status: Status, values: FloatArray) -> None:
        """Enter the values of a running task; (columns,)."""
        start = self._count + 1 + task * len(COLUMNS)
        words = np.ascontiguousarray(values, dtype=np.float64).view(np.int64)
        if self._window is None:
            self._memory[start : start + len(words)] = words
        else:
            self._window.Put(words, 0, start)
            self._window.Flush(0)
        self._swap(task, Status.RUNNING, status)

    def ask_to_stop(self, code: int) -> bool:
        """Ask all groups to stop; the first code given, above 0, stays; return whether it is this."""
        return self._swap(self._count, 0, code)

    def stop_code(self) -> int:
        """Return the code that some rank asked to stop with, 0 for none."""
        return int(self._get(self._count, 1)[0])

    def _get(self, start: int, count: int) -> IntArray:
        if self._window is None:
            return self._memory[start : start + count].copy()
        words = np.empty(count, dtype=np.int64)
        self._window.Get(words, 0, start)
        self._window.Flush(0)
        return words

    def _swap(self, place: int, expected: int, new: int) -> bool:
        if self._window is None:
            found = int(self._memory[place])
            if found == expected:
                self._memory[place] = new
            return found == expected
        result = np.empty(1, dtype=np.int64)
        self._window.Compare_and_swap(
            np.array([new], dtype=np.int64), np.array([expected], dtype=np.int64), result, 0, place
        )
        self._window.Flush(0)
        return bool(result[0] == expected)
