"""Runs a command in a terminal of its own, as a user at a keyboard does."""

import fcntl
import os
import pty
import select
import struct
import termios
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

CTRL_C, CTRL_Z = b"\x03", b"\x1a"
CLEAR = "\r\x1b[2K"
ROWS, COLUMNS = 40, 100


@dataclass
class Terminal:
    """A command at work in a terminal.

    Attributes:
        process: Its process.
        text: All that it has shown so far.
        largest_gap: Longest time in which nothing was shown [s], from the first output on.
    """

    process: int
    keyboard: int
    text: str = ""
    largest_gap: float = 0.0

    def type(self, keys: bytes) -> None:
        os.write(self.keyboard, keys)

    def lines(self) -> list[str]:
        """Return the lines that stay on the screen."""
        return [line.rsplit(CLEAR, 1)[-1] for line in self.text.replace("\r\n", "\n").split("\n")]


def once(mark: str, keys: bytes) -> Callable[[Terminal], object]:
    """Return what types keys as soon as a text has been shown."""
    typed: list[bytes] = []

    def press(terminal: Terminal) -> None:
        if mark in terminal.text and not typed:
            typed.append(keys)
            terminal.type(keys)

    return press


def in_terminal(
    command: Sequence[str],
    folder: Path,
    environment: Mapping[str, str],
    meanwhile: Callable[[Terminal], object] = lambda terminal: None,
    seconds: float = 120.0,
) -> tuple[int, Terminal]:
    """Run a command in a terminal until it ends.

    Args:
        command: Program and arguments.
        folder: Where it runs.
        environment: Its variables.
        meanwhile: Called after each output, to act on what is seen.
        seconds: How long it may take.

    Returns:
        Its exit status (negative: the signal that ended it) and what was seen.
    """
    process, keyboard = pty.fork()
    if process == 0:
        os.chdir(folder)
        os.execvpe(command[0], list(command), {**environment, "TERM": "xterm"})
    fcntl.ioctl(keyboard, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
    seen, end, last = Terminal(process, keyboard), monotonic() + seconds, None
    try:
        while True:
            ready, _, _ = select.select([keyboard], [], [], 0.1)
            now = monotonic()
            assert now < end, seen.text
            if not ready:
                continue
            try:
                received = os.read(keyboard, 1 << 16)
            except OSError:
                break
            if last is not None:
                seen.largest_gap = max(seen.largest_gap, now - last)
            last = now
            seen.text += received.decode(errors="replace")
            meanwhile(seen)
    finally:
        os.close(keyboard)
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]), seen
