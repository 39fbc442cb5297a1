"""PETSc is initialized with the user's options, before anything imports it."""

from collections.abc import Sequence

from pearlite_petsc.launch.libraries import find_petsc4py

find_petsc4py()

import petsc4py  # noqa: E402


def initialize_petsc(options: Sequence[str]) -> None:
    """Initialise PETSc; does nothing once it is. Collective over all ranks.

    PETSc's own signal handler is left out: a signal asks the program to stop, it is no crash, and
    a reader of the output who has gone (SIGPIPE) must not end all ranks.

    Args:
        options: PETSc options as on a command line.
    """
    petsc4py.init(["pearlite_petsc", *options, "-no_signal_handler"])
