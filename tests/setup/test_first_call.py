"""The first call on a machine: what it says, asks and survives before anything is there."""

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.setup.conftest import NOT_INSTALLED, USER, Checkout, message
from tests.terminal import CTRL_C, in_terminal, once

# A sudo that does what it is asked, and lets others know that it did.
SUDO = '#!/bin/sh\necho "sudo $*" >>"$CALLS"\n[ "$1" != -n ] || shift\nAS_ROOT=1 exec "$@"\n'


@pytest.mark.parametrize("option", ["--help", "-h", "--version"])
def test_questions_are_answered_once_before_anything_is_installed(
    option: str, checkout: Checkout
) -> None:
    checkout.stand_in("dpkg-query", NOT_INSTALLED)
    done = checkout.call("run", option, PEARLITE_RANKS="16")
    assert done.returncode == 0
    assert done.stderr == ""
    word = "pearlite_petsc 0" if option == "--version" else "usage: pearlite run"
    assert done.stdout.count(word) == 1
    assert not any(call.startswith(("apt-get", "sudo", "mpirun")) for call in checkout.calls())
    assert not (checkout.folder / ".venv").exists()


@pytest.mark.parametrize(
    "arguments", [["--frobnicate"], ["--resume", "--overwrite"], ["--", "ksp_view"]]
)
def test_wrong_options_are_refused_before_anything_is_installed(
    arguments: list[str], checkout: Checkout
) -> None:
    checkout.stand_in("dpkg-query", NOT_INSTALLED)
    done = checkout.call("run", *arguments)
    assert done.returncode == 2
    assert arguments[0].strip("-") in message(done) or arguments[1] in message(done)
    assert not any(call.startswith("apt-get") for call in checkout.calls())


def test_help_without_python_says_what_installs_it(checkout: Checkout) -> None:
    (checkout.bin / "python3").unlink()
    done = checkout.call("run", "--help")
    assert done.returncode == 1
    assert "./pearlite.sh setup installs it" in message(done)


def test_an_interrupted_apt_is_healed_through_sudo(checkout: Checkout) -> None:
    checkout.stand_in("dpkg-query", NOT_INSTALLED)
    checkout.stand_in("id", USER)
    checkout.stand_in("sudo", SUDO)
    # As a user, dpkg --audit sees nothing.
    dpkg = 'echo "dpkg $*" >>"$CALLS"\n[ "$1" != --audit ] || echo "${AS_ROOT:+half-configured}"\n'
    checkout.stand_in("dpkg", f"#!/bin/sh\n{dpkg}[ $1 != --compare-versions ]\n")
    assert checkout.call("setup").returncode == 0
    calls = checkout.calls()
    heal, update = calls.index("dpkg --configure -a"), calls.index("apt-get -q -q update")
    assert heal < update


def test_an_apt_that_was_stopped_is_no_success(checkout: Checkout) -> None:
    checkout.stand_in("dpkg-query", "#!/bin/sh\nexit 1\n")
    done = checkout.call("setup")
    assert done.returncode == 1
    assert "apt-get was stopped before it had installed python3 " in done.stderr.splitlines()[-1]
    assert done.stderr.splitlines()[-1].endswith("; call again")


def test_a_sudo_that_wants_a_password_without_a_terminal_is_one_message(
    checkout: Checkout,
) -> None:
    checkout.stand_in("dpkg-query", NOT_INSTALLED)
    checkout.stand_in("id", USER)
    checkout.stand_in("sudo", "#!/bin/sh\nexit 1\n")
    done = checkout.call("setup")
    assert done.returncode == 1
    for word in ("sudo wants a password", "no terminal", "sudo -v", "python3-petsc4py"):
        assert word in message(done)
    assert not any(call.startswith("apt-get") for call in checkout.calls())


def test_the_size_is_said_before_it_is_fetched(checkout: Checkout) -> None:
    checkout.stand_in("dpkg-query", NOT_INSTALLED)
    said = 'echo "Reading lists"\necho "Need to get 312 MB of archives."\n'
    checkout.stand_in(
        "apt-get",
        f'#!/bin/sh\ncase $* in *--assume-no*) {said}exit 1 ;; esac\necho "apt-get $*" >>"$CALLS"\necho "fetched" >&2\n',
    )
    done = checkout.call("setup")
    assert done.returncode == 0, done.stderr
    lines = done.stderr.splitlines()
    assert "installing" in lines[0] and "packages of the distribution" in lines[0]
    size = lines.index("pearlite.sh: Need to get 312 MB of archives.")
    # The first is of the update.
    assert "fetched" in lines[size + 1 :]
    assert not any("Reading" in line for line in lines)


def test_ctrl_c_while_the_environment_is_made_is_one_line(checkout: Checkout) -> None:
    Path(checkout.environment["SLOW"]).touch()
    command = [str(checkout.folder / "pearlite.sh"), "setup"]
    press = once("installing the Python packages", CTRL_C)
    status, seen = in_terminal(command, checkout.folder, checkout.environment, press)
    assert status == 130
    assert "pearlite.sh: stopped; the next call" in seen.lines()[-2]
    assert "Traceback" not in seen.text
    Path(checkout.environment["SLOW"]).unlink()
    assert checkout.call("setup").returncode == 0


@pytest.fixture
def read_only(checkout: Checkout) -> Iterator[Checkout]:
    """A checkout that is set up for "run" and that this user may not write."""
    assert checkout.call("setup").returncode == 0
    # Where everybody may look, which pytest's own folders are not.
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        place = Path(folder) / "checkout"
        shutil.copytree(checkout.folder, place, symlinks=True)
        shutil.copytree(checkout.bin, Path(folder) / "bin", symlinks=True)
        made = Checkout(place, Path(folder) / "bin", dict(checkout.environment))
        made.environment["PATH"] = str(made.bin)
        made.environment["PEARLITE_PYTHON"] = str(made.bin / "python3")
        made.environment["CALLS"] = str(Path(folder) / "calls")
        assert made.call("setup").returncode == 0
        place.chmod(0o555)
        yield made
        place.chmod(0o755)


def test_a_read_only_checkout_says_for_what_it_is_not_set_up(read_only: Checkout) -> None:
    other = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]
    start = other if os.geteuid() == 0 else []
    done = subprocess.run(
        [*start, str(read_only.folder / "pearlite.sh"), "test"],
        env={**read_only.environment, "PATH": f"{read_only.bin}:/usr/bin:/bin"},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 1
    assert "not set up for 'test': call ./pearlite.sh setup test as its owner" in message(done)


def test_the_environment_works_by_itself_once_it_is_activated(checkout: Checkout) -> None:
    checkout.call("setup")
    venv = checkout.folder / ".venv"
    (path,) = venv.glob("lib/python3*/site-packages/pearlite.pth")
    root, petsc, threads = path.read_text().splitlines()
    assert root == str(checkout.folder)
    assert petsc == f"{checkout.environment['PETSC_DIR']}/lib/python3/dist-packages"
    environment: dict[str, str] = {"OMP_NUM_THREADS": "4"}
    exec(threads.replace("os.environ", "environment"), {"environment": environment})
    assert environment == {"OMP_NUM_THREADS": "4", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [str(venv / "bin" / "pearlite"), "run", "a b.toml"], env=checkout.environment, check=False
    )
    assert done.returncode == 0
    assert checkout.calls()[-1] == "python -m pearlite_petsc run a b.toml"
