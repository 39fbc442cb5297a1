"""What a rank does between two steps of its crack: looks for stops, shows news, keeps tables."""

from time import monotonic

import numpy as np

from pearlite_petsc.ensemble.board import Board
from pearlite_petsc.ensemble.products import Products
from pearlite_petsc.ensemble.progress import Progress
from pearlite_petsc.ensemble.status import Status
from pearlite_petsc.ensemble.stop import StopRequest
from pearlite_petsc.ensemble.trouble import tell_not_writable
from pearlite_petsc.launch.display import Screen

LOOK_SECONDS = 0.1
"""How often a rank looks whether another one was asked to stop."""


class Lookout:
    """Looks after all that goes on beside the cracks, on every rank.

    Args:
        board: Status of all tasks.
        request: Signals and wall time of this rank.
        screen: What the user sees.
        progress: Shows news, on the first rank.
        products: What is kept up to date beside the checkpoints, on the first rank.
    """

    def __init__(
        self,
        board: Board,
        request: StopRequest,
        screen: Screen,
        progress: Progress | None,
        products: Products | None,
    ) -> None:
        self._board, self._request, self._screen = board, request, screen
        self._progress, self._products = progress, products
        self._looked = 0.0
        self._stopping = False

    def between_steps(self) -> bool:
        """Serve the others, show news, and return whether to stop."""
        board = self._board
        board.tick()
        code = self._request.code()
        if code and not self._stopping:
            board.ask_to_stop(code)
            self._stopping = True
        now = monotonic()
        if now - self._looked >= LOOK_SECONDS:
            self._looked = now
            self._stopping = self._stopping or board.stop_code() != 0
        if self._progress is not None and (self._stopping or self._progress.is_due()):
            self._show_and_keep(self._progress)
        return self._stopping

    def show_the_end(self) -> None:
        """Show that no crack grows any more."""
        if self._progress is not None:
            self._show_and_keep(self._progress, last=True)

    def _show_and_keep(self, progress: Progress, last: bool = False) -> None:
        """Write what is finished, and show news; all is written as soon as a stop is wanted."""
        status = self._board.status()
        if self._products is not None:
            try:
                finished = np.isin(status, (Status.DONE, Status.FAILED))
                self._products.update(finished, now=self._stopping)
            except (OSError, RuntimeError) as error:
                # HDF5 reports a full disk as either.
                self._products = None
                tell_not_writable(self._board, self._screen, error)
        if last or progress.is_due():
            products = self._products
            remark = (lambda number: "") if products is None else products.remark
            progress.show(status, self._board.values(), last, remark)
