"""What is said when the output folder cannot be written."""

import logging

from pearlite_petsc.ensemble.board import Board
from pearlite_petsc.ensemble.stop import NOT_WRITABLE
from pearlite_petsc.launch.display import Screen

_log = logging.getLogger(__name__)


def tell_not_writable(board: Board, screen: Screen, error: Exception) -> None:
    """Stop all ranks because the output cannot be written; the first one says so.

    Args:
        board: Of the work that is to stop.
        screen: What the user sees.
        error: What went wrong, with the name of the file.
    """
    _log.error("the output cannot be written: %s", error)
    if board.ask_to_stop(NOT_WRITABLE):
        screen.trouble(f"the output cannot be written: {error}")
