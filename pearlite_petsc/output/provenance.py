"""What ran, where and when: enough to run it again."""

import json
import platform
import subprocess
import sys
from collections.abc import Mapping, Sequence
from datetime import datetime
from importlib import metadata
from pathlib import Path
from typing import Any

import pearlite_petsc
from pearlite_petsc.output.whole_file import whole_file

_LIBRARIES = ("numpy", "scipy", "shapely", "h5py", "meshio", "matplotlib", "petsc4py", "mpi4py")


def provenance(
    command: Sequence[str],
    started: datetime,
    ended: datetime,
    seeds: Mapping[str, int],
    libraries: Mapping[str, str],
    ranks: int,
) -> dict[str, Any]:
    """Return versions, host, command, times and seeds as JSON can hold them.

    Args:
        command: Command line as given.
        started, ended: Times with their zone.
        seeds: Random seeds by name.
        libraries: Versions that only the caller knows (PETSc, MPI).
        ranks: Processes of the run.
    """
    return {
        "program": f"pearlite_petsc {pearlite_petsc.__version__}",
        "source": source_state(Path(__file__).parent),
        "command": list(command),
        "started": started.isoformat(timespec="seconds"),
        "ended": ended.isoformat(timespec="seconds"),
        "wall_s": round((ended - started).total_seconds(), 3),
        "host": platform.node(),
        "system": platform.platform(),
        "processor": _processor(),
        "python": sys.version.split()[0],
        "ranks": ranks,
        "seeds": dict(seeds),
        "libraries": {
            **{name: found for name in _LIBRARIES if (found := _version(name))},
            **libraries,
        },
    }


def ended_now(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return a provenance whose run ends now, the rest as it was found at the first look."""
    started, now = datetime.fromisoformat(content["started"]), datetime.now().astimezone()
    ended = now.isoformat(timespec="seconds")
    return {**content, "ended": ended, "wall_s": round((now - started).total_seconds(), 3)}


def write_provenance(path: Path, content: Mapping[str, Any]) -> None:
    """Write ``provenance.json``."""
    with whole_file(path) as partial:
        partial.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def source_state(folder: Path) -> dict[str, Any]:
    """Return the git commit of the program's folder and whether its tracked files were changed.

    Both are None where the folder is no git checkout or git is missing.
    """
    commit = _git(folder, "rev-parse", "HEAD")
    # An installed copy may lie inside somebody else's checkout.
    if commit is None or not _git(folder, "ls-files", "."):
        return {"commit": None, "changed": None}
    status = _git(folder, "status", "--porcelain", "--untracked-files=no", ".")
    return {"commit": commit, "changed": bool(status)}


def _git(folder: Path, *arguments: str) -> str | None:
    try:
        answer = subprocess.run(
            ["git", "-C", str(folder), *arguments],
            capture_output=True,
            text=True,
            timeout=10,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return answer.stdout.strip()


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        # As Debian 12 packs h5py.
        return getattr(sys.modules.get(name), "__version__", None)


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()
