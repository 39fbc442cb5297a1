"""Whether the modules of MPI and PETSc are there, and where the distribution keeps petsc4py."""

import importlib.util
import os
import sys
from pathlib import Path

DISTRIBUTION = Path("/usr/lib/petscdir")


def find_petsc4py(distribution: Path = DISTRIBUTION) -> None:
    """Let Python find the petsc4py of PETSC_DIR or of the distribution where it finds none.

    Args:
        distribution: Folder of the distribution's PETSc builds; those for real numbers are taken.
    """
    if importlib.util.find_spec("petsc4py") is not None:
        return
    folders = [path / "lib/python3/dist-packages" for path in distribution.glob("petsc*/*-real")]
    own = os.environ.get("PETSC_DIR")
    if own:
        folders += [Path(own, os.environ.get("PETSC_ARCH", ""), "lib")]
        folders += [Path(own, "lib/python3/dist-packages")]
    # The user's choice first, then the newest.
    for folder in reversed(folders):
        if (folder / "petsc4py").is_dir():
            sys.path.append(str(folder))
            return


def missing_libraries() -> str:
    """Return in one line which modules of MPI and PETSc cannot be found and what helps, or ""."""
    find_petsc4py()
    names = [name for name in ("mpi4py", "petsc4py") if importlib.util.find_spec(name) is None]
    if not names:
        return ""
    return (
        f"{' and '.join(names)} cannot be found by {sys.executable}: use ./pearlite.sh run or its "
        "environment (. .venv/bin/activate), or install PETSc with petsc4py and set PETSC_DIR"
    )


def unusable_library(error: Exception) -> str:
    """Return in one line why a module of MPI or PETSc cannot be loaded and what may help."""
    reason = str(error).strip().splitlines()[-1] if str(error).strip() else type(error).__name__
    return (
        f"MPI or PETSc cannot be loaded ({reason}): mpi4py and petsc4py must fit each other, the MPI "
        "that is installed and numpy; those of Debian 12 need numpy 1 (pip install 'numpy<2')"
    )
