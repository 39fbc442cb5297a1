"""Exit statuses of all commands; docs/reference.md lists them for users."""

from enum import IntEnum


class ExitStatus(IntEnum):
    """What a command tells the shell."""

    DONE = 0
    """Everything was done."""

    BROKEN = 1
    """An error of the program, an output that cannot be written, or a claim that does not hold."""

    BAD_INPUT = 2
    """Input that cannot be used; nothing was written."""

    SOME_FAILED = 3
    """The run is complete, but some of its tasks failed."""

    INTERRUPTED = 130
    """Stopped by a signal or the wall time."""
