"""What travels between the ranks of a domain, and that they solve for what one rank does."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.mpi.launch import SECONDS, command, environment

SCRIPT = (sys.executable, str(Path(__file__).with_name("domain_script.py")))


@pytest.mark.parametrize("ranks", [2, 3])
def test_a_domain_on_several_ranks_is_that_of_one(ranks: int) -> None:
    done = subprocess.run(
        command(ranks, SCRIPT), env=environment(), capture_output=True, text=True, timeout=SECONDS
    )
    assert done.returncode == 0, done.stderr
    assert f"{ranks} ranks are one" in done.stdout
