"""A run as its user sees it in a terminal, by the launcher and by mpirun, whatever mpirun holds back."""

import os
import shutil
import signal
import sys
from pathlib import Path

import pytest

from tests.mpi.launch import SCENE, environment
from tests.terminal import CTRL_C, Terminal, in_terminal, once

RUN = [sys.executable, "-m", "pearlite_petsc.run"]
HERE = ["small.toml", "--output", "out"]
FINISHED = "undeformed_m0_dk10: "

# As Open MPI 5 does: a line goes on when it has ended, not before.
WHOLE_LINES = """#!/bin/bash
{mpirun} "$@" | {python} -c 'import sys
for line in sys.stdin: sys.stdout.write(line); sys.stdout.flush()'
exit ${{PIPESTATUS[0]}}
"""

BROKEN = """
import sys
from pearlite_petsc.ensemble import session
from pearlite_petsc.run import main
def run(self):
    raise RuntimeError("by the test")
session.Session.run = run
sys.exit(main())
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a scene and an mpirun that forwards whole lines only."""
    (tmp_path / "small.toml").write_text(SCENE)
    mpirun = tmp_path / "bin" / "mpirun"
    mpirun.parent.mkdir()
    mpirun.write_text(WHOLE_LINES.format(mpirun=shutil.which("mpirun"), python=sys.executable))
    mpirun.chmod(0o755)
    return tmp_path


def variables(folder: Path) -> dict[str, str]:
    known = environment()
    return {**known, "PATH": os.pathsep.join([str(folder / "bin"), known["PATH"]])}


@pytest.mark.parametrize(
    "command",
    [[*RUN, "--ranks", "2", *HERE], ["mpirun", "-n", "2", *RUN, *HERE]],
    ids=["launcher", "mpirun"],
)
def test_bar_and_lines_arrive_while_the_work_goes_on(command: list[str], folder: Path) -> None:
    finished_at_first_line: list[int] = []

    def look(terminal: Terminal) -> None:
        if FINISHED in terminal.text and not finished_at_first_line:
            kept = folder / "out" / "checkpoint" / "finished"
            finished_at_first_line.append(len(list(kept.glob("*.h5"))))

    status, seen = in_terminal(command, folder, variables(folder), look)
    assert status == 0
    # Had the output been held back until the end, all six would have been there.
    assert finished_at_first_line[0] < 6
    assert "starting" in seen.text
    assert "/6 done, " in seen.text
    assert "writing the results" in seen.text
    lines = [line for line in seen.lines() if not line.startswith("note: ")]
    assert lines[0] == "small: 6 tasks on 2 rank(s), 1 a task"
    assert [line.split("]")[0] for line in lines[1:7]] == [f"[{n}/6" for n in range(1, 7)]
    assert lines[7].startswith("6 done, 0 failed, 0 missing; ")
    assert lines[8:] == [""]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stop_ends_with_130_the_line_and_a_clean_prompt(
    number: signal.Signals, folder: Path
) -> None:
    sent: list[int] = []

    def stop(terminal: Terminal) -> None:
        if FINISHED in terminal.text and not sent:
            sent.append(number)
            if number == signal.SIGINT:
                terminal.type(CTRL_C)
            else:
                os.kill(terminal.process, number)

    command = [*RUN, "--ranks", "2", *HERE]
    status, seen = in_terminal(command, folder, variables(folder), stop)
    assert status == 130, seen.text
    *_, last, prompt = seen.lines()
    assert last.startswith(f"stopped ({number.name} received): ")
    assert "--resume goes on" in last
    assert prompt == ""
    status, seen = in_terminal([*command, "--resume"], folder, variables(folder))
    assert status == 0
    assert seen.lines()[-2].startswith("6 done, 0 failed, 0 missing; ")


def test_ctrl_c_before_the_ranks_are_there_is_130_too(folder: Path) -> None:
    mpirun = folder / "bin" / "mpirun"
    mpirun.write_text("#!/bin/sh\necho slow\nexec sleep 60\n")
    command = [*RUN, "--ranks", "2", *HERE]
    status, seen = in_terminal(command, folder, variables(folder), once("slow", CTRL_C))
    assert status == 130
    assert seen.lines()[-2].startswith("stopped (SIGINT received) before the ranks were ready")
    assert not (folder / "out").exists()


def test_what_fails_later_ends_with_the_programs_own_line(folder: Path) -> None:
    (folder / "broken.py").write_text(BROKEN)
    mpirun = folder / "bin" / "mpirun"
    start = f"{shutil.which('mpirun')} -n 2 {sys.executable} broken.py"
    # In the place of "-n 2 python -m pearlite_petsc.run".
    mpirun.write_text(f'#!/bin/sh\nshift 5\nexec {start} "$@"\n')
    status, seen = in_terminal([*RUN, "--ranks", "2", *HERE], folder, variables(folder))
    assert status == 1
    assert seen.text.count("Traceback") == 1
    assert seen.lines()[-2].startswith("pearlite: an error of the program on rank ")
    assert "MPI_ABORT" not in seen.text


def test_bad_input_is_one_line_without_mpirun(folder: Path) -> None:
    (folder / "bin" / "mpirun").write_text("#!/bin/sh\necho started\n")
    command = [*RUN, "--ranks", "16", *HERE, "--set", "elements.widht_um=3"]
    status, seen = in_terminal(command, folder, variables(folder))
    assert status == 2
    first, *rest = seen.lines()
    assert "did you mean width_um?" in first
    assert rest == [""]
