"""What a user sees of a run: lines that scroll, and below them a bar where there is a terminal."""

import logging
import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Event, RLock, Thread
from time import monotonic
from typing import Protocol, TextIO

_log = logging.getLogger(__name__)

REDRAW_SECONDS = 1.0
QUIET_SECONDS = 60.0
"""Without a terminal: how long nothing may be said while the work goes on."""

BAR_WIDTH = 20
_CLEAR = "\r\x1b[2K"


@dataclass(frozen=True, slots=True)
class Standing:
    """Where a run stands.

    Attributes:
        doing: What it is doing ("growing").
        done, running, failed, total: Numbers of tasks; a total of 0 where they are not the matter.
        left_s: Time that is expected to be left [s].
    """

    doing: str
    done: int = 0
    running: int = 0
    failed: int = 0
    total: int = 0
    left_s: float = 0.0

    def text(self, age: float, elapsed: float) -> str:
        """Return it as one line.

        Args:
            age: Time since it was so [s].
            elapsed: Time since the start of the run [s].
        """
        if not self.total:
            return f"{self.doing}, {clock(elapsed)} so far"
        filled = BAR_WIDTH * self.done // self.total
        left = clock(max(self.left_s - age, 0.0))
        return (
            f"[{'#' * filled}{'-' * (BAR_WIDTH - filled)}] {self.done}/{self.total} done, "
            f"{self.running} running, {self.failed} failed, {left} left, {clock(elapsed)} so far"
        )


class Screen(Protocol):
    """Where a run speaks to its user: a ``Display``, or the channel to the launcher's."""

    def line(self, text: str) -> None:
        """Show a line for good."""

    def trouble(self, text: str) -> None:
        """Show a line about something wrong, on standard error."""

    def stand(self, standing: Standing) -> None:
        """Show where the run stands until it is told otherwise."""

    def stopping(self, signal_name: str) -> None:
        """Say at once that a signal was received; may be called by its handler."""


class Display:
    """Lines on a stream; on a terminal a bar below them that is redrawn every second.

    Without a terminal the bar is a line, only where nothing else was shown for a minute. A stream
    whose reader has gone stops nothing. A context manager: outside it only lines are shown.

    Args:
        stream: Where to write; standard output by default.
        terminal: Whether it is one that can redraw a line.
        quiet: See ``QUIET_SECONDS``.
    """

    def __init__(
        self, stream: TextIO | None = None, terminal: bool = False, quiet: float = QUIET_SECONDS
    ) -> None:
        self._stream = sys.stdout if stream is None else stream
        self._terminal, self._quiet = terminal, quiet
        self._started = self._spoke = monotonic()
        self._standing: tuple[Standing, float] | None = None
        self._drawn = self._ended = False
        self._notice = ""
        self._lock, self._wake = RLock(), Event()
        self._thread = Thread(target=self._keep_alive, daemon=True)

    def __enter__(self) -> "Display":
        self._thread.start()
        return self

    def __exit__(self, *exc: object) -> None:
        self._ended = True
        self._wake.set()
        self._thread.join()
        with self._lock:
            self._standing = None
            self._clear()

    def line(self, text: str) -> None:
        """Show a line for good."""
        self.pass_on(f"{text}\n", self._stream)

    def trouble(self, text: str) -> None:
        """Show a line about something wrong, on standard error."""
        self.pass_on(f"{text}\n", sys.stderr)

    def stand(self, standing: Standing) -> None:
        """Show where the run stands until it is told otherwise."""
        with self._lock:
            self._standing = standing, monotonic()
            self._draw()

    def pass_on(self, text: str, stream: TextIO) -> None:
        """Write whole lines to a stream, above the bar."""
        with self._lock:
            self._clear()
            say(stream, text)
            self._spoke = monotonic()
            self._draw()

    def stopping(self, signal_name: str) -> None:
        """Say at once that a signal was received; may be called by its handler.

        The ranks may need some seconds to stop, and Open MPI 5 gives those that it stops half of one.
        """
        # Writing is left to the other thread: a handler may have come into the midst of it.
        self._notice = f"stopping ({signal_name} received); --resume will go on from here"
        self._wake.set()

    def _keep_alive(self) -> None:
        while not self._ended:
            self._wake.wait(REDRAW_SECONDS)
            self._wake.clear()
            with self._lock:
                if self._notice:
                    self._standing = None
                    self.line(self._notice)
                    self._notice = ""
                self._draw()

    def _draw(self) -> None:
        if self._standing is None or not self._thread.is_alive():
            return
        now, (standing, since) = monotonic(), self._standing
        text = standing.text(now - since, now - self._started)
        if self._terminal:
            say(self._stream, f"{_CLEAR}{text[: self._width()]}")
            self._drawn = True
        elif now - self._spoke >= self._quiet:
            say(self._stream, f"{text}\n")
            self._spoke = now

    def _clear(self) -> None:
        if self._drawn:
            say(self._stream, _CLEAR)
            self._drawn = False

    def _width(self) -> int:
        try:
            columns = os.get_terminal_size(self._stream.fileno()).columns
        except (OSError, ValueError):
            columns = shutil.get_terminal_size().columns
        # A full line would wrap, and a terminal without a size says 0.
        return (columns or 80) - 1


def say(stream: TextIO, text: str) -> None:
    """Write a text and send it off; what cannot be written is only logged."""
    try:
        stream.write(text)
        stream.flush()
    except (OSError, ValueError) as error:
        _log.debug("message lost (%s): %s", error, text.rstrip())


def clock(seconds: float) -> str:
    """Return a time as minutes and seconds, with hours if there are any."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


@contextmanager
def display_of_rank() -> Iterator[Display]:
    """Yield the display of a rank that nobody but its starter (mpirun, srun, a shell) started."""
    path = _terminal_of_starter()
    if path is None:
        with Display(terminal=is_terminal(sys.stdout)) as display:
            yield display
        return
    # Past mpirun, which would hold the bar back until its line ends.
    with (
        os.fdopen(os.open(path, os.O_WRONLY | os.O_NOCTTY), "w") as stream,
        Display(stream, terminal=True) as display,
    ):
        yield display


def is_terminal(stream: TextIO) -> bool:
    """Return whether a stream leads to a terminal that can redraw a line."""
    # Open MPI 4 shows its ranks a terminal whatever its own output is.
    if started_by_mpi() or os.environ.get("TERM", "dumb") == "dumb":
        return False
    return stream.isatty()


def started_by_mpi() -> bool:
    """Return whether mpirun, mpiexec or srun started this process."""
    return any(name in os.environ for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"))


_STARTERS = ("mpirun", "mpiexec", "prterun", "orterun", "prted", "orted", "hydra_pmi_proxy")


def _terminal_of_starter() -> str | None:
    """Return the terminal to which the mpirun above this process writes, if it does and we may."""
    if not started_by_mpi() or os.environ.get("TERM", "dumb") == "dumb":
        return None
    starter, process = 0, os.getppid()
    try:
        while process > 1:
            stat = Path(f"/proc/{process}/stat").read_text(encoding="utf-8")
            name, _, rest = stat.partition("(")[2].rpartition(")")
            if not name.startswith(_STARTERS):
                break
            starter, process = process, int(rest.split()[1])
        path = os.readlink(f"/proc/{starter}/fd/1") if starter else ""
        if path.startswith(("/dev/pts/", "/dev/tty")) and os.access(path, os.W_OK):
            return path
    except OSError:
        pass
    return None
