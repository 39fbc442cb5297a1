"""petsc4py is found where PETSc is, and one line says what is missing or does not fit."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

from pearlite_petsc.launch.libraries import find_petsc4py, unusable_library
from tests.mpi.launch import environment


@pytest.fixture
def no_petsc4py(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(sys, "path", ["here"])
    for name in ("PETSC_DIR", "PETSC_ARCH"):
        monkeypatch.delenv(name, raising=False)


def with_petsc4py(folder: Path) -> str:
    (folder / "petsc4py").mkdir(parents=True)
    return str(folder)


@pytest.mark.usefixtures("no_petsc4py")
def test_the_distributions_newest_is_found(tmp_path: Path) -> None:
    # A build for complex numbers is none that the program can use.
    with_petsc4py(tmp_path / "petsc3.18" / "x86-complex" / "lib/python3/dist-packages")
    found = with_petsc4py(tmp_path / "petsc3.18" / "x86-real" / "lib/python3/dist-packages")
    find_petsc4py(tmp_path)
    assert sys.path == ["here", found]


@pytest.mark.usefixtures("no_petsc4py")
@pytest.mark.parametrize(
    "inside, arch", [("arch-opt/lib", "arch-opt"), ("lib", ""), ("lib/python3/dist-packages", "")]
)
def test_that_of_petsc_dir_comes_first(
    inside: str, arch: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_petsc4py(tmp_path / "petsc3.18" / "x86-real" / "lib/python3/dist-packages")
    own = with_petsc4py(tmp_path / "own" / inside)
    monkeypatch.setenv("PETSC_DIR", str(tmp_path / "own"))
    monkeypatch.setenv("PETSC_ARCH", arch)
    find_petsc4py(tmp_path)
    assert sys.path == ["here", own]


def test_what_python_finds_by_itself_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: object())
    monkeypatch.setattr(sys, "path", ["here"])
    with_petsc4py(tmp_path / "petsc3.18" / "x86-real" / "lib/python3/dist-packages")
    find_petsc4py(tmp_path)
    assert sys.path == ["here"]


def test_a_library_that_does_not_fit_is_one_line() -> None:
    text = unusable_library(ImportError("first\nnumpy.core.multiarray failed to import"))
    assert "\n" not in text
    assert "numpy.core.multiarray failed to import" in text
    assert "numpy<2" in text


def test_a_petsc4py_for_another_numpy_is_one_line_on_all_ranks(tmp_path: Path) -> None:
    # What numpy 2 says to the petsc4py of Debian 12.
    reason = "numpy.dtype size changed, may indicate binary incompatibility"
    (tmp_path / "petsc4py.py").write_text(f"def init(arguments): raise ValueError({reason!r})\n")
    known = environment()
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pearlite_petsc.run",
            "--ranks",
            "2",
            "--output",
            str(tmp_path / "o"),
        ],
        env={**known, "PYTHONPATH": f"{tmp_path}:{known['PYTHONPATH']}"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith(f"MPI or PETSc cannot be loaded ({reason})")


@pytest.mark.parametrize("own, found", [(None, "none"), ("cma", "cma")])
def test_copies_between_processes_are_off_unless_the_user_wants_them(
    own: str | None, found: str
) -> None:
    pytest.importorskip("mpi4py")
    name = "OMPI_MCA_btl_vader_single_copy_mechanism"
    known = {key: value for key, value in environment().items() if key != name}
    code = (
        f"import os; from pearlite_petsc.world import world; world(); print(os.environ[{name!r}])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=known if own is None else {**known, name: own},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.stdout == f"{found}\n", done.stderr
