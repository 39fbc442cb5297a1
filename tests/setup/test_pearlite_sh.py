"""pearlite.sh with stand-ins for apt, Python and MPI: what it calls, and what it refuses."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.setup.conftest import ROOT, USER, Checkout, message


def run_call(checkout: Checkout, *arguments: str, **environment: str) -> str:
    """Return how ``run`` calls Python once everything is set up."""
    checkout.calls()
    done = checkout.call("run", *arguments, **environment)
    assert done.returncode == 0, done.stderr
    (call,) = checkout.calls()
    return call


def test_help_names_every_command_and_sets_nothing_up(checkout: Checkout) -> None:
    done = checkout.call("help")
    assert done.returncode == 0
    for command in ("run", "test", "exec", "setup", "PEARLITE_RANKS", "PETSC_DIR"):
        assert command in done.stdout
    assert checkout.calls() == []
    assert not (checkout.folder / ".venv").exists()


@pytest.mark.parametrize(
    ("arguments", "word"), [(["rnu"], "rnu"), (["setup", "all"], "all"), (["exec"], "exec")]
)
def test_unknown_command_is_refused_in_one_line_before_anything_is_set_up(
    checkout: Checkout, arguments: list[str], word: str
) -> None:
    done = checkout.call(*arguments)
    assert done.returncode == 2
    assert word in message(done)
    assert checkout.calls() == []


def test_run_starts_as_many_ranks_as_asked_for(checkout: Checkout) -> None:
    checkout.call("setup")
    call = run_call(checkout, "a b.toml", "--dry-run", PEARLITE_RANKS="3")
    assert call == "python -m pearlite_petsc.run --ranks 3 a b.toml --dry-run"


@pytest.mark.parametrize("value", ["0", "-1", "two", "1.5", "2 --help"])
def test_number_of_ranks_that_is_none_is_refused(checkout: Checkout, value: str) -> None:
    done = checkout.call("run", PEARLITE_RANKS=value)
    assert done.returncode == 2
    assert value in message(done)


def test_threads_a_rank_do_not_change_the_number_of_ranks(checkout: Checkout) -> None:
    checkout.call("setup")
    default = run_call(checkout)
    assert int(default.rpartition("--ranks ")[2]) in range(1, (os.cpu_count() or 1) + 1)
    assert run_call(checkout, OMP_NUM_THREADS="1") == default
    assert run_call(checkout, OMP_NUM_THREADS="64") == default


def test_environment_has_one_thread_a_rank_and_allows_root_and_many_ranks(
    checkout: Checkout,
) -> None:
    checkout.call("setup")
    shown = checkout.call("exec", "env", OMP_NUM_THREADS="8", OMPI_MCA_btl_tcp_if_include="eth0")
    lines = shown.stdout.splitlines()
    for line in (
        "OMP_NUM_THREADS=1",
        "OPENBLAS_NUM_THREADS=1",
        "MPLBACKEND=Agg",
        "OMPI_ALLOW_RUN_AS_ROOT=1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
        "PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe",
        "OMPI_MCA_btl_tcp_if_include=eth0",
        f"PYTHONPATH={checkout.folder}",
    ):
        assert line in lines
    assert "OMPI_MCA_btl_tcp_if_include=lo" in checkout.call("exec", "env").stdout.splitlines()
    checkout.stand_in("id", USER)
    assert "ALLOW_RUN_AS_ROOT" not in checkout.call("exec", "env").stdout


def test_exec_hands_on_arguments_working_directory_and_exit_status(checkout: Checkout) -> None:
    checkout.call("setup")
    done = checkout.call("exec", "sh", "-c", 'pwd; echo "$1"; exit 7', "sh", "a  b*")
    assert done.stdout.splitlines() == [str(checkout.folder.parent), "a  b*"]
    assert done.returncode == 7


def test_script_works_through_a_link_and_without_a_home(checkout: Checkout, tmp_path: Path) -> None:
    link = tmp_path / "link"
    link.symlink_to(checkout.folder / "pearlite.sh")
    del checkout.environment["HOME"]
    done = subprocess.run(
        [str(link), "exec", "env"], env=checkout.environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert f"VIRTUAL_ENV={checkout.folder}/.venv" in done.stdout.splitlines()


def test_checks_fail_if_any_one_of_them_fails(checkout: Checkout) -> None:
    checkout.call("setup", "test")
    tools = checkout.folder / ".venv" / "bin"
    (tools / "mpirun").unlink()
    fcg = 'mkdir -p "$8"; printf "head\\n1\\n2\\n3\\n4\\n5\\n" >"$8/fcg.csv"'
    (checkout.folder / "runs").mkdir()

    def write(name: str, text: str) -> None:
        (tools / name).write_text(f"#!/bin/sh\n{text}\n")
        (tools / name).chmod(0o755)

    passing = {"ruff": "", "mypy": "", "python": "", "mpirun": fcg}
    failing = {
        "ruff": "exit 1",
        "mypy": "exit 1",
        "python": "exit 1",
        "mpirun": f"{fcg}; exit 3",
    }
    for name, text in passing.items():
        write(name, text)
    done = checkout.call("test")
    assert done.returncode == 0, done.stdout + done.stderr
    for name, text in failing.items():
        write(name, text)
        done = checkout.call("test")
        assert done.returncode == 1, name
        assert "failed:" in done.stderr.splitlines()[-1]
        write(name, passing[name])
    write("mpirun", fcg.replace("4\\n5\\n", "4\\n"))
    assert checkout.call("test").returncode == 1


def test_ci_prints_the_closing_line_and_hands_on_the_status(tmp_path: Path) -> None:
    (tmp_path / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "run", tmp_path / ".ci" / "run")
    script = tmp_path / "pearlite.sh"
    for closing, status in (
        ("============ 12 passed, 3 skipped in 4.56s ============", 0),
        ("12 passed in 61.20s (0:01:01)", 0),
        ("============ 1 failed, 11 passed in 4.56s ============", 1),
    ):
        script.write_text(f"#!/bin/sh\necho '{closing}'\necho 'style failed' >&2\nexit {status}\n")
        script.chmod(0o755)
        done = subprocess.run([str(tmp_path / ".ci" / "run")], capture_output=True, text=True)
        assert done.returncode == status
        assert done.stdout.splitlines()[-1] == closing
    script.write_text("#!/bin/sh\necho collected\n")
    done = subprocess.run([str(tmp_path / ".ci" / "run")], capture_output=True, text=True)
    assert done.returncode == 1


def test_scripts_pass_shellcheck() -> None:
    shellcheck = shutil.which("shellcheck")
    if shellcheck is None:
        pytest.skip("shellcheck is not installed")
    subprocess.run([shellcheck, str(ROOT / "pearlite.sh"), str(ROOT / ".ci" / "run")], check=True)
