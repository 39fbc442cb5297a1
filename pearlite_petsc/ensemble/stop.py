"""Requests to stop: signals and the wall time; a clean stop at the next step of every crack.

What takes long between two steps and can be left anywhere (meshes, figures) is left at once.
"""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from types import FrameType, TracebackType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGHUP)

WALL_TIME = 1000
"""Stop code of the wall time; a signal's is its number."""

NOT_WRITABLE = 1001
"""Stop code of an output folder that cannot be written."""


LOOK_SECONDS = 0.2
"""How often what can be left anywhere looks whether to stop."""


class StoppedError(Exception):
    """A stop was asked for inside of something that can be left anywhere."""


@contextmanager
def left_when(stopping: Callable[[], object]) -> Iterator[None]:
    """Leave what runs inside, wherever it is, once a stop is wanted.

    It must not call MPI or PETSc, nor change anything that is used after it. The timer asks from a
    signal handler, between two steps of Python: others are served and news are shown meanwhile.

    Args:
        stopping: Whether to stop; called every ``LOOK_SECONDS``.

    Raises:
        StoppedError: A stop was wanted.
    """
    if threading.current_thread() is not threading.main_thread():
        # No signals there, so no timer either.
        yield
        return

    looking = False

    def look(number: int, frame: FrameType | None) -> None:
        nonlocal looking
        if looking:
            return
        looking = True
        try:
            stop = stopping()
        finally:
            looking = False
        if stop:
            raise StoppedError

    before = signal.signal(signal.SIGALRM, look)
    signal.setitimer(signal.ITIMER_REAL, LOOK_SECONDS, LOOK_SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def describe(code: int) -> str:
    """Return what a stop code means."""
    if code == WALL_TIME:
        return "wall time reached"
    if code == NOT_WRITABLE:
        return "the output cannot be written"
    return f"{signal.Signals(code).name} received"


class StopRequest:
    """Remembers the first signal instead of dying from it, and the wall time.

    A second SIGINT ends the process as it always does.

    Args:
        seconds: Wall time allowed from ``started`` on, None for no limit.
        started: Start of the run by ``time.monotonic``.

    Attributes:
        tell: Called by the handler with the name of the first signal.
    """

    def __init__(self, seconds: float | None, started: float) -> None:
        self._end = None if seconds is None else started + seconds
        self._signal = 0
        self._before: dict[signal.Signals, Any] = {}
        self.tell: Callable[[str], object] = lambda name: None

    def __enter__(self) -> "StopRequest":
        handler: Callable[[int, FrameType | None], None] = self._remember
        for number in SIGNALS:
            # nohup and shells let what they start ignore some for good.
            if signal.getsignal(number) is not signal.SIG_IGN:
                self._before[number] = signal.signal(number, handler)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def code(self) -> int:
        """Return why to stop, 0 for going on."""
        if self._signal:
            return self._signal
        return WALL_TIME if self._end is not None and monotonic() >= self._end else 0

    def _remember(self, number: int, frame: FrameType | None) -> None:
        if self._signal and number == signal.SIGINT:
            signal.signal(number, signal.SIG_DFL)
            signal.raise_signal(number)
        if not self._signal:
            self._signal = number
            self.tell(signal.Signals(number).name)
