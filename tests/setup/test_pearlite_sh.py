"""pearlite.sh with stand-ins for apt, Python and MPI: what it calls, when, and what it refuses."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.setup.conftest import ROOT, Checkout

NOT_INSTALLED = "#!/bin/sh\nexit 1\n"
USER = "#!/bin/sh\necho 1000\n"


def run_call(checkout: Checkout, *arguments: str, **environment: str) -> str:
    """Return how ``run`` calls Python once everything is set up."""
    checkout.calls()
    done = checkout.call("run", *arguments, **environment)
    assert done.returncode == 0, done.stderr
    (call,) = checkout.calls()
    return call


def message(done: subprocess.CompletedProcess[str]) -> str:
    """Return the only line that a refused call prints."""
    assert done.stdout == ""
    lines = done.stderr.splitlines()
    assert len(lines) == 1, done.stderr
    return lines[0]


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


def test_first_call_makes_an_environment_that_sees_the_distribution(checkout: Checkout) -> None:
    done = checkout.call("setup")
    assert done.returncode == 0, done.stderr
    calls = checkout.calls()
    assert any("-m venv --clear --system-site-packages" in call for call in calls)
    assert any("-m pip install" in call for call in calls)
    assert not any(call.startswith(("apt-get", "sudo")) for call in calls)


def test_second_call_asks_neither_apt_nor_pip_nor_python(checkout: Checkout) -> None:
    checkout.call("setup")
    checkout.calls()
    assert checkout.call("exec", "true").returncode == 0
    assert checkout.calls() == []


def test_tools_of_the_checks_are_added_to_the_same_environment(checkout: Checkout) -> None:
    checkout.call("setup")
    checkout.calls()
    assert checkout.call("setup", "test").returncode == 0
    calls = checkout.calls()
    assert any("-m pip install" in call for call in calls)
    assert not any("--system-site-packages" in call for call in calls)
    assert checkout.call("exec", "true").returncode == 0
    assert checkout.calls() == []


def test_type_checker_has_an_environment_of_its_own(checkout: Checkout) -> None:
    checkout.call("setup", "test")
    venv = checkout.folder / ".venv"
    assert (venv / "bin" / "mypy").readlink() == venv / "types" / "bin" / "mypy"
    wanted = (venv / "types" / "requirements.txt").read_text().splitlines()
    assert [line for line in wanted if line.startswith("numpy==")]
    assert not [
        line
        for line in (venv / "requirements.txt").read_text().splitlines()
        if line.startswith("numpy")
    ]


@pytest.mark.parametrize("name", ["pyproject.toml", "pearlite.sh"])
def test_changed_project_file_makes_the_environment_again(checkout: Checkout, name: str) -> None:
    checkout.call("setup")
    checkout.calls()
    with (checkout.folder / name).open("a") as file:
        file.write("\n# changed\n")
    assert checkout.call("exec", "true").returncode == 0
    assert any("-m venv --clear" in call for call in checkout.calls())


def test_interrupted_set_up_is_repaired_by_the_next_call(checkout: Checkout) -> None:
    broken = Path(checkout.environment["BROKEN"])
    broken.touch()
    done = checkout.call("exec", "true")
    assert done.returncode == 1
    assert "pip" in done.stderr.splitlines()[-1]
    checkout.calls()
    broken.unlink()
    assert checkout.call("exec", "true").returncode == 0
    assert any("-m venv --clear" in call for call in checkout.calls())


def test_killed_addition_of_the_test_tools_is_not_taken_for_finished(checkout: Checkout) -> None:
    checkout.call("setup")
    broken = Path(checkout.environment["BROKEN"])
    broken.touch()
    assert checkout.call("setup", "test").returncode == 1
    broken.unlink()
    checkout.calls()
    assert checkout.call("setup", "test").returncode == 0
    assert any("-m venv --clear" in call for call in checkout.calls())


def test_removed_environment_is_made_again(checkout: Checkout) -> None:
    checkout.call("setup")
    checkout.calls()
    shutil.rmtree(checkout.folder / ".venv")
    assert checkout.call("exec", "true").returncode == 0
    assert any("-m venv" in call for call in checkout.calls())


def test_missing_packages_are_installed_without_a_question_asked(checkout: Checkout) -> None:
    checkout.stand_in("dpkg-query", NOT_INSTALLED)
    checkout.stand_in("apt-get", '#!/bin/sh\necho "apt-get [$DEBIAN_FRONTEND] $*" >>"$CALLS"\n')
    assert checkout.call("setup").returncode == 0
    update, *_, install = [call for call in checkout.calls() if call.startswith("apt-get")]
    assert update.startswith("apt-get [noninteractive]")
    assert "update" in update
    assert install.startswith("apt-get [noninteractive]")
    for package in ("python3-petsc4py-real", "python3-mpi4py", "openmpi-bin", "python3-venv"):
        assert package in install.split()
    assert "-y" in install.split()


@pytest.mark.parametrize(
    ("version", "from_distribution"), [("1.8.5-2+b1", False), ("2.1.0-1", True), ("(none)", False)]
)
def test_shapely_is_the_distributions_where_that_is_new_enough(
    checkout: Checkout, version: str, from_distribution: bool
) -> None:
    if not Path("/usr/bin/dpkg").exists():
        pytest.skip("compares versions with dpkg")
    checkout.stand_in("dpkg-query", NOT_INSTALLED)
    checkout.stand_in("apt-cache", f"#!/bin/sh\necho '  Candidate: {version}'\n")
    checkout.stand_in("dpkg", '#!/bin/sh\n[ "$1" = --audit ] || exec /usr/bin/dpkg "$@"\n')
    assert checkout.call("setup").returncode == 0
    install = [call.split() for call in checkout.calls() if call.startswith("apt-get")][-1]
    assert ("python3-shapely" in install) == from_distribution
    assert ("python3-meshio" in install) == from_distribution


def test_without_root_and_sudo_the_missing_packages_are_named(checkout: Checkout) -> None:
    checkout.stand_in("dpkg-query", NOT_INSTALLED)
    checkout.stand_in("id", USER)
    (checkout.bin / "sudo").unlink()
    done = checkout.call("setup")
    assert done.returncode == 1
    assert "root or sudo" in message(done)
    assert "python3-petsc4py" in message(done)
    assert checkout.calls() == []


def test_a_user_installs_through_sudo(checkout: Checkout) -> None:
    checkout.stand_in("dpkg-query", NOT_INSTALLED)
    checkout.stand_in("id", USER)
    assert checkout.call("setup").returncode == 0
    assert any(
        call.startswith("sudo env DEBIAN_FRONTEND=noninteractive apt-get")
        for call in checkout.calls()
    )


def test_a_user_needs_no_sudo_where_the_packages_are_installed(checkout: Checkout) -> None:
    checkout.stand_in("id", USER)
    (checkout.bin / "sudo").unlink()
    assert checkout.call("setup").returncode == 0


def test_another_distribution_is_told_what_is_needed(checkout: Checkout) -> None:
    (checkout.bin / "apt-get").unlink()
    done = checkout.call("setup")
    assert done.returncode == 1
    for word in ("python3-petsc4py", "openmpi-bin", "PETSC_DIR", "pip install ."):
        assert word in message(done)


def test_own_petsc_takes_nothing_from_the_distribution(checkout: Checkout, tmp_path: Path) -> None:
    petsc = tmp_path / "petsc"
    (petsc / "include").mkdir(parents=True)
    (petsc / "include" / "petscversion.h").write_text(
        "#define PETSC_VERSION_RELEASE 1\n#define PETSC_VERSION_MAJOR    3\n"
        "#define PETSC_VERSION_MINOR    21\n#define PETSC_VERSION_SUBMINOR 4\n"
    )
    (petsc / "arch" / "lib" / "petsc4py").mkdir(parents=True)
    own = {"PETSC_DIR": str(petsc), "PETSC_ARCH": "arch"}
    checkout.stand_in("dpkg-query", NOT_INSTALLED)
    (checkout.bin / "apt-get").unlink()
    done = checkout.call("setup", **own)
    assert done.returncode == 0, done.stderr
    assert not any("--system-site-packages" in call for call in checkout.calls())
    venv = checkout.folder / ".venv"
    assert (venv / "constraints.txt").read_text() == "petsc4py==3.21.*\nnumpy<2\n"
    assert not (venv / "bin" / "mpirun").exists()
    shown = checkout.call("exec", "env", **own).stdout.splitlines()
    path = next(line for line in shown if line.startswith("PATH="))
    assert path.startswith(f"PATH={venv}/bin:{petsc}/arch/bin:")
    assert f"PYTHONPATH={checkout.folder}:{petsc}/arch/lib" in shown
    # The distribution's PETSc is another environment.
    checkout.stand_in("apt-get", "#!/bin/sh\n")
    checkout.calls()
    checkout.call("exec", "true")
    assert any("--system-site-packages" in call for call in checkout.calls())


def test_own_petsc_that_is_no_folder_is_refused(checkout: Checkout) -> None:
    done = checkout.call("setup", PETSC_DIR="/nowhere/petsc")
    assert done.returncode == 2
    assert "/nowhere/petsc" in message(done)


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
