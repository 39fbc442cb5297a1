"""The example scripts are all on their page, and run on one rank and on two."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.docs.pages import ROOT
from tests.docs.test_commands import SECONDS, environment

EXAMPLES = ROOT / "docs" / "examples"
SCRIPTS = sorted(path for path in EXAMPLES.glob("*.py") if "plt.subplots" in path.read_text())


def run(folder: Path, *command: str) -> str:
    done = subprocess.run(
        command, cwd=folder, env=environment(), capture_output=True, text=True, timeout=SECONDS
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_is_on_the_page_with_its_command_and_its_picture(script: Path) -> None:
    page = (EXAMPLES / "README.md").read_text(encoding="utf-8")
    assert f"python docs/examples/{script.name}\n" in page
    assert f"](../pictures/{script.stem}.png)" in page
    assert f'savefig("{script.stem}.png"' in script.read_text(encoding="utf-8")


def told(folder: Path, script: Path, *starter: str) -> list[str]:
    """Run a script that writes its picture; return what it says of its results."""
    text = run(folder, *starter, sys.executable, str(script))
    picture = folder / f"{script.stem}.png"
    assert picture.read_bytes()[:4] == b"\x89PNG"
    picture.unlink()
    # What ``run`` shows on the way tells wall times and ranks.
    shown = ("[", f"{script.stem}: ")
    lines = [line for line in text.splitlines() if not line.startswith(shown)]
    return [line for line in lines if " done, " not in line]


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_runs_and_writes_its_picture(script: Path, tmp_path: Path) -> None:
    assert told(tmp_path, script)


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_says_the_same_on_two_ranks(script: Path, tmp_path: Path) -> None:
    assert told(tmp_path, script, "mpirun", "-n", "2") == told(tmp_path, script)
