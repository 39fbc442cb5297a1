"""A copy of pearlite.sh in an empty folder, with stand-ins for Python, apt and MPI that log calls."""

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOOLS = (
    "sh env dirname readlink cat chmod grep sed sort tail paste sha256sum nproc mkdir ln rm mktemp "
    "wc flock true sleep"
)

# "-m venv DIR" leaves a copy of itself in DIR; pip fails while a file "broken" stands beside,
# and takes its time while there is one called "slow".
PYTHON = """#!/bin/sh
echo "python $*" >>"$CALLS"
case "$*" in
    "-m venv"*)
        for folder; do :; done
        rm -rf "$folder"
        mkdir -p "$folder/bin" "$folder/lib/python3.11/site-packages"
        cp "$0" "$folder/bin/python" ;;
    "-I - "*) exec "$REAL_PYTHON" "$@" ;;
    *pearlite_petsc.run_options*) exec "$REAL_PYTHON" "$@" ;;
    "-m pip"*) [ ! -e "$SLOW" ] || exec sleep 60; [ ! -e "$BROKEN" ] ;;
esac
"""


@dataclass
class Checkout:
    """A folder with pearlite.sh whose outside world is made of stand-ins."""

    folder: Path
    bin: Path
    environment: dict[str, str] = field(default_factory=dict)

    def stand_in(self, name: str, text: str) -> None:
        path = self.bin / name
        path.unlink(missing_ok=True)
        path.write_text(text)
        path.chmod(0o755)

    def call(self, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [str(self.folder / "pearlite.sh"), *arguments],
            env=self.environment | environment,
            cwd=self.folder.parent,
            capture_output=True,
            text=True,
            timeout=60,
            # Without a terminal, whatever the tests were started from.
            start_new_session=True,
        )

    def calls(self) -> list[str]:
        """Return the logged calls since the last time."""
        log = Path(self.environment["CALLS"])
        lines = log.read_text().splitlines() if log.exists() else []
        log.unlink(missing_ok=True)
        return lines


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    folder, binaries = tmp_path / "checkout", tmp_path / "bin"
    folder.mkdir()
    binaries.mkdir()
    for name in ("pearlite.sh", "pyproject.toml"):
        shutil.copy(ROOT / name, folder / name)
    (folder / "pearlite_petsc").symlink_to(ROOT / "pearlite_petsc")
    for name in [*TOOLS.split(), "cp"]:
        found = shutil.which(name, path="/usr/bin:/bin")
        assert found, name
        (binaries / name).symlink_to(found)
    log = 'echo "${0##*/} $*" >>"$CALLS"\n'
    made = Checkout(folder, binaries)
    made.stand_in("python3", PYTHON)
    made.stand_in("id", "#!/bin/sh\necho 0\n")
    made.stand_in("dpkg-query", "#!/bin/sh\necho installed\n")
    made.stand_in("dpkg", "#!/bin/sh\n[ $1 != --compare-versions ]\n")
    made.stand_in("apt-cache", "#!/bin/sh\n")
    for name in ("apt-get", "sudo", "mpirun"):
        made.stand_in(name, "#!/bin/sh\n" + log)
    made.environment = {
        "PATH": str(binaries),
        "PEARLITE_PYTHON": str(binaries / "python3"),
        # A folder of the distribution's kind, so that no installed PETSc is looked for.
        "PETSC_DIR": "/usr/lib/petscdir/stand-in",
        "CALLS": str(tmp_path / "calls"),
        "REAL_PYTHON": sys.executable,
        "BROKEN": str(tmp_path / "broken"),
        "SLOW": str(tmp_path / "slow"),
        "HOME": os.environ.get("HOME", "/"),
    }
    return made


# Nothing is, until apt-get has been asked to.
NOT_INSTALLED = '#!/bin/sh\ngrep -qs "apt-get.* -y .*install" "$CALLS" && echo installed\n'
USER = "#!/bin/sh\necho 1000\n"
"""A stand-in for ``id`` of one who is not root."""


def message(done: subprocess.CompletedProcess[str]) -> str:
    """Return the only line that a refused call prints."""
    assert done.stdout == ""
    lines = done.stderr.splitlines()
    assert len(lines) == 1, done.stderr
    return lines[0]
