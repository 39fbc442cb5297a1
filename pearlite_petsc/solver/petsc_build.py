"""What PETSc was built as, for the record of a run."""

import re
from pathlib import Path

import petsc4py

from pearlite_petsc.solver.petsc import PETSc


def petsc_facts() -> dict[str, str]:
    """Return PETSc's version, size of integers, folder and configure line (empty if unknown)."""
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
