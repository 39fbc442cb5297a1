"""How pearlite.sh makes its environment, with stand-ins for apt and Python: what, when and from where."""

import shutil
from pathlib import Path

import pytest

from tests.setup.conftest import NOT_INSTALLED, USER, Checkout, message


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
    checkout.stand_in("apt-get", '#!/bin/sh\necho "apt-get $*" >>"$CALLS"\n')
    checkout.calls()
    checkout.call("exec", "true")
    assert any("--system-site-packages" in call for call in checkout.calls())


def test_own_petsc_that_is_no_folder_is_refused(checkout: Checkout) -> None:
    done = checkout.call("setup", PETSC_DIR="/nowhere/petsc")
    assert done.returncode == 2
    assert "/nowhere/petsc" in message(done)
