"""One name for all commands: the list, the dispatch, and what they all share."""

import importlib
import subprocess
import sys

import pytest

import pearlite_petsc
from pearlite_petsc.__main__ import COMMANDS, main
from pearlite_petsc.command_line import CommandParser, expected_ranks
from pearlite_petsc.exit_status import ExitStatus
from tests.docs.test_commands import environment


def test_without_a_command_all_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == main(["--help"]) == ExitStatus.DONE
    listed = capsys.readouterr().out
    for name, what in COMMANDS.items():
        assert f"  {name} " in listed
        assert what in listed


def test_the_version_is_the_package_s(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == ExitStatus.DONE
    assert capsys.readouterr().out == f"pearlite_petsc {pearlite_petsc.__version__}\n"


def test_an_unknown_command_is_refused_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["raport", "runs/quickstart"]) == ExitStatus.BAD_INPUT
    assert capsys.readouterr().err == "pearlite: raport is not a command, did you mean report?\n"
    assert main(["frobnicate"]) == ExitStatus.BAD_INPUT
    assert "known are run, mesh" in capsys.readouterr().err


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_describes_itself_by_the_name_that_starts_it(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main([name, "--help"])
    assert left.value.code == 0
    assert capsys.readouterr().out.startswith(f"usage: pearlite {name} ")
    assert importlib.import_module(f"pearlite_petsc.{name.replace('-', '_')}").main.__doc__


@pytest.mark.parametrize("name", COMMANDS)
def test_an_unknown_option_is_one_line_and_the_status_of_bad_input(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main([name, "--frobnicate"])
    assert left.value.code == ExitStatus.BAD_INPUT
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith(f"pearlite {name}: ")


def test_help_starts_neither_mpi_nor_petsc_nor_loads_numbers() -> None:
    program = (
        "import sys; from pearlite_petsc.__main__ import main; main(['--help']);"
        "sys.exit(', '.join(sys.modules.keys() & {'mpi4py', 'petsc4py', 'numpy', 'matplotlib'}) or 0)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=environment(),
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.stderr == ""
    assert "calibrate" in done.stdout


def test_the_package_runs_as_a_module() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "pearlite_petsc", "mesh", "nothing.toml"],
        env=environment(),
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == ExitStatus.BAD_INPUT
    assert done.stderr.count("\n") == 1


def test_only_the_first_rank_complains(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "1")
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "3")
    with pytest.raises(SystemExit):
        CommandParser("run", "").parse_args(["--frobnicate"])
    assert capsys.readouterr() == ("", "")
    assert expected_ranks() == 3
