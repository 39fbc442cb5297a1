"""Ranks take tasks from the board while the first one computes; ``test_board`` starts it."""

import sys
from time import monotonic, sleep

import mpi4py

mpi4py.rc.thread_level = "funneled"

import numpy as np  # noqa: E402
from mpi4py import MPI  # noqa: E402

from pearlite_petsc.ensemble.board import Board  # noqa: E402
from pearlite_petsc.ensemble.group import wait_for_all  # noqa: E402
from pearlite_petsc.ensemble.status import COLUMNS, Status  # noqa: E402

TASKS = 400
MOST_SECONDS = 60.0


def main() -> None:
    world = MPI.COMM_WORLD
    start = np.zeros(TASKS, dtype=np.int64), np.full((TASKS, len(COLUMNS)), np.nan)
    board = Board(world, *(start if world.rank == 0 else (None, None)))
    mine = []
    if world.rank == 0:
        # The one whose memory the board is computes and does not enter MPI before the others
        # have taken all; it looks at its memory directly.
        end = monotonic() + MOST_SECONDS
        while (board._memory[:TASKS] == Status.OPEN).any():
            assert monotonic() < end, "others waited for the first rank"
    for task in range(TASKS):
        if board.status()[task] == Status.OPEN and board.claim(task):
            mine.append(task)
            board.finish(task, Status.DONE, np.array([world.rank, 0.1 * task, 3.0]))
            sleep(1e-4)
    board.ask_to_stop(10 + world.rank)
    wait_for_all(world, board.tick)
    taken = world.gather(mine)
    codes = world.allgather(board.stop_code())
    status, values = board.status(), board.values()
    board.close()
    if world.rank == 0 and taken is not None:
        whole = np.sort(np.concatenate([np.array(own, dtype=int) for own in taken]))
        assert np.array_equal(whole, np.arange(TASKS)), "a task was taken twice or never"
        assert (status == Status.DONE).all()
        for rank, own in enumerate(taken):
            assert (values[own, 0] == rank).all()
        assert np.array_equal(values[:, 1], 0.1 * np.arange(TASKS))
        assert len(set(codes)) == 1, "ranks disagree on why to stop"
        assert codes[0] in {10 + rank for rank in range(world.size)}
        sys.stdout.write("each task was taken once\n")


if __name__ == "__main__":
    main()
