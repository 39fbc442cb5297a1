"""``import pearlite_petsc as pp``: its names, and nothing started before it is needed."""

import importlib
import subprocess
import sys

import pytest

import pearlite_petsc as pp
from tests.docs.test_commands import environment


def python(program: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=environment(),
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_package_offers_its_names_and_no_others() -> None:
    assert sorted(dir(pp)) == sorted(pp.__all__)
    for name in pp.__all__:
        assert getattr(pp, name).__doc__, name
    with pytest.raises(AttributeError, match="has no attribute grow"):
        pp.grow  # noqa: B018


def test_importing_the_package_loads_no_library() -> None:
    heavy = "{'numpy', 'mpi4py', 'petsc4py', 'matplotlib', 'h5py', 'scipy'}"
    program = f"import sys, pearlite_petsc; print(sorted(sys.modules.keys() & {heavy}))"
    assert python(program) == "[]\n"


def test_a_mesh_is_made_and_drawn_without_mpi_and_petsc() -> None:
    program = (
        "import sys, pearlite_petsc as pp;"
        "pp.Growth, pp.grow_crack, pp.run, pp.Results;"
        "pp.build_mesh(pp.Scene(), 'severe_AT').plot();"
        "print(sorted(name for name in sys.modules if 'MPI' in name or 'PETSc' in name))"
    )
    assert python(program) == "[]\n"


def test_importing_the_command_does_not_hide_the_function_of_its_name() -> None:
    command = importlib.import_module("pearlite_petsc.run")
    assert pp.run is not command
    assert callable(pp.run)
    assert callable(command.main)
