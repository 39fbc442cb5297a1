"""What all commands share: parser, options, and messages that only one rank gives.

Nothing here starts MPI or PETSc, so that ``--help`` and bad input are answered at once.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pearlite_petsc
from pearlite_petsc.exit_status import ExitStatus

_RANK_VARIABLES = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID")
_SIZE_VARIABLES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_NTASKS")


class CommandParser(argparse.ArgumentParser):
    """Parser of one command: options in full, errors in one line on one rank.

    Args:
        command: Name of the command, after ``pearlite``.
        description: What it does, one sentence.
        epilog: Examples and notes, shown as they stand.
        options: Whatever else ``argparse.ArgumentParser`` takes.
    """

    def __init__(self, command: str, description: str, epilog: str = "", **options: Any) -> None:
        super().__init__(
            prog=f"pearlite {command}".rstrip(),
            description=description,
            epilog=epilog,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
            **options,
        )
        self.add_argument("--version", action=_Version, nargs=0, help="print the version")

    def print_help(self, file: Any = None) -> None:
        """Print the help, on the first rank only."""
        if is_first_rank():
            super().print_help(file)

    def error(self, message: str) -> Any:
        """Leave with the exit status of bad input."""
        complain(f"{self.prog}: {message} (--help lists the options)")
        sys.exit(ExitStatus.BAD_INPUT)


class _Version(argparse.Action):
    """Prints the version, on the first rank only, and leaves."""

    def __call__(self, parser: argparse.ArgumentParser, *found: object) -> None:
        say(f"pearlite_petsc {pearlite_petsc.__version__}")
        parser.exit()


def add_set_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--set TABLE.KEY=VALUE``, which changes values of the scene."""
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="TABLE.KEY=VALUE",
        help="change a value of the scene; may be repeated",
    )


def add_load_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--load LAW.py``, which adds laws that the scene may choose."""
    parser.add_argument(
        "--load",
        action="append",
        default=[],
        type=Path,
        metavar="LAW.py",
        help="add the laws of a Python file of your own; may be repeated",
    )


def add_output_option(
    parser: argparse.ArgumentParser,
    help: str,
    default: Path | None = None,
    metavar: str = "DIR",
) -> None:
    """Add ``--output``, where the command writes.

    Args:
        parser: The command's.
        help: What is written there; the default is added to it.
        default: None where the command finds it from its other arguments and says so in ``help``.
        metavar: DIR, or the kind of file.
    """
    if default is not None:
        help = f"{help}; default {default}"
    parser.add_argument("--output", type=Path, default=default, metavar=metavar, help=help)


def given_arguments(arguments: Sequence[str] | None) -> list[str]:
    """Return the arguments of a command; None stands for those of the process."""
    return list(sys.argv[1:] if arguments is None else arguments)


def expected_ranks() -> int:
    """Return the number of ranks as the starter of the job says it, before MPI is there."""
    return next((int(os.environ[name]) for name in _SIZE_VARIABLES if name in os.environ), 1)


def is_first_rank() -> bool:
    """Return whether this is the rank that speaks, before MPI is there."""
    return next((os.environ[name] for name in _RANK_VARIABLES if name in os.environ), "0") == "0"


def say(text: str) -> None:
    """Write a line to standard output, on the first rank only."""
    if is_first_rank():
        sys.stdout.write(f"{text}\n")


def complain(text: str) -> None:
    """Write a line to standard error, on the first rank only."""
    if is_first_rank():
        sys.stderr.write(f"{text}\n")
