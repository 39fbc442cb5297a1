"""Tasks are taken once each, without a rank that hands them out."""

import subprocess
import sys
from pathlib import Path

from tests.mpi.launch import SECONDS, command, environment

SCRIPT = (sys.executable, str(Path(__file__).with_name("board_script.py")))


def test_three_ranks_take_each_task_once_while_the_first_computes() -> None:
    done = subprocess.run(
        command(3, SCRIPT), env=environment(), capture_output=True, text=True, timeout=SECONDS
    )
    assert done.returncode == 0, done.stderr
    assert "each task was taken once" in done.stdout


def test_one_rank_needs_no_window() -> None:
    import numpy as np
    from mpi4py import MPI

    from pearlite_petsc.ensemble.board import Board
    from pearlite_petsc.ensemble.status import COLUMNS, Status

    status = np.array([Status.OPEN, Status.DONE])
    board = Board(MPI.COMM_SELF, status, np.full((2, len(COLUMNS)), 7.0))
    assert not board.claim(1)
    assert board.claim(0)
    assert not board.claim(0)
    board.release(0)
    assert board.claim(0)
    board.finish(0, Status.FAILED, np.array([1.0, 2.0, 5.0]))
    assert board.status().tolist() == [Status.FAILED, Status.DONE]
    assert board.values().tolist() == [[1.0, 2.0, 5.0], [7.0, 7.0, 7.0]]
    assert board.stop_code() == 0
    board.ask_to_stop(15)
    board.ask_to_stop(2)
    assert board.stop_code() == 15
    board.close()
