"""Start of PETSc with the user's options, and what it was built as."""

import re
from collections.abc import Sequence
from pathlib import Path

import petsc4py


def start_petsc(options: Sequence[str]) -> None:
    """Initialise PETSc; does nothing once it is. Collective over all ranks.

    PETSc's own signal handler is left out: a signal asks the program to stop, it is no crash, and
    a reader of the output who has gone (SIGPIPE) must not end all ranks.

    Args:
        options: PETSc options as on a command line.
    """
    petsc4py.init(["pearlite_petsc", *options, "-no_signal_handler"])


def petsc_facts() -> dict[str, str]:
    """Return PETSc's version, size of integers, folder and configure line (empty if unknown)."""
    from pearlite_petsc.solver.petsc import PETSc

    config = petsc4py.get_config()
    return {
        "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        "petsc_integer_bytes": str(PETSc.IntType().itemsize),
        "petsc_folder": config.get("PETSC_DIR", ""),
        "petsc_configure": _configure_line(),
    }


def _configure_line() -> str:
    # PETSc tells it only inside the output of -log_view; distributions leave its files out.
    try:
        maps = Path("/proc/self/maps").read_text(encoding="utf-8").splitlines()
        names = {line.split(maxsplit=5)[-1] for line in maps if "/libpetsc" in line}
        for name in sorted(names):
            for found in re.finditer(rb"--[a-z][ -~]{40,}", Path(name).read_bytes()):
                if b" --with-" in found.group():
                    return found.group().decode("ascii").strip()
    except OSError:
        pass
    return ""
