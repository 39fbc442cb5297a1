"""``pip install .`` into an environment of its own, and the program used outside the checkout."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.docs.pages import ROOT, blocks
from tests.docs.test_commands import QUICK, environment

SECONDS = 600


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Install into an empty environment on the distribution's packages; return what to run with."""
    folder = tmp_path_factory.mktemp("installed")
    source = folder / "source"
    shutil.copytree(ROOT / "pearlite_petsc", source / "pearlite_petsc")
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    settings = environment()
    settings.pop("PYTHONPATH")
    settings["PATH"] = os.pathsep.join([str(folder / "venv" / "bin"), os.environ["PATH"]])
    python = os.environ.get("PEARLITE_PYTHON", "/usr/bin/python3")
    for command in (
        [python, "-m", "venv", "--system-site-packages", str(folder / "venv")],
        [str(folder / "venv" / "bin" / "python"), "-m", "pip", "install", "-q", str(source)],
    ):
        subprocess.run(command, check=True, env=settings, cwd=folder, timeout=SECONDS)
    return settings


def call(settings: dict[str, str], folder: Path, *command: str) -> str:
    done = subprocess.run(
        command, env=settings, cwd=folder, capture_output=True, text=True, timeout=SECONDS
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.slow
def test_the_console_script_and_the_module_are_the_same(
    installed: dict[str, str], tmp_path: Path
) -> None:
    for command in ("run", "mesh", "report", "calibrate", "verify", "bench"):
        text = call(installed, tmp_path, "pearlite", command, "--help")
        assert text.startswith(f"usage: pearlite {command} ")
        assert text == call(
            installed, tmp_path, "python", "-m", "pearlite_petsc", command, "--help"
        )
    place = "import pearlite_petsc; print(pearlite_petsc.__file__)"
    package = Path(call(installed, tmp_path, "python", "-c", place).strip()).parent
    assert package.is_relative_to(Path(installed["PATH"].split(os.pathsep)[0]).parent)
    assert (package / "py.typed").is_file()


@pytest.mark.slow
def test_a_run_and_the_script_of_the_readme_work_outside_the_checkout(
    installed: dict[str, str], tmp_path: Path
) -> None:
    changes = [word for change in QUICK for word in ("--set", change)]
    assert "5 done, 0 failed" in call(installed, tmp_path, "pearlite", "run", *changes)
    # An installed program brings no scene files; what is left out of a scene is the quickstart's.
    (tmp_path / "runs" / "quickstart.toml").write_text("")
    script = "".join(block.script for block in blocks(ROOT / "README.md", "python"))
    (tmp_path / "script.py").write_text(f"{script}print(crack, results)\n")
    for command in (["python"], ["mpirun", "-n", "2", "python"]):
        text = call(installed, tmp_path, *command, "script.py")
        assert "<Crack severe_AT 0 at 18 MPa sqrt(m): grown" in text
        assert "5 cracks" in text
