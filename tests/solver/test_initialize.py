"""PETSc, once imported, leaves the process its signals."""

import subprocess
import sys

WRITES_TO_NOBODY = """
import os
from pearlite_petsc.solver.petsc import PETSc

read, write = os.pipe()
os.close(read)
try:
    os.write(write, b"x")
except BrokenPipeError:
    print("went on")
"""


def test_a_reader_who_has_gone_does_not_end_the_process() -> None:
    done = subprocess.run(
        [sys.executable, "-c", WRITES_TO_NOBODY], capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr, done.returncode) == ("went on\n", "", 0)
