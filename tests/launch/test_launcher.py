"""The launcher, with scripts in the place of mpirun and its ranks."""

import os
import signal
import subprocess
import sys
from pathlib import Path
from time import monotonic

import pytest

from tests.mpi.launch import ROOT, environment
from tests.terminal import CTRL_C, CTRL_Z, Terminal, in_terminal, once

SCRIPT = str(Path(__file__).with_name("launcher_script.py"))

# A rank that works for some seconds and stops cleanly on a signal.
RANK = """
import signal, sys, time
from pearlite_petsc.launch.channel import Channel
from pearlite_petsc.launch.display import Standing
found = []
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, lambda number, frame: found.append(number))
channel = Channel.connect()
channel.stand(Standing("growing", 1, 1, 0, 5, 9.0))
channel.line("ready")
end = time.monotonic() + float(sys.argv[1])
while not found and time.monotonic() < end:
    time.sleep(0.01)
channel.line(f"found {[signal.Signals(n).name for n in found]}")
channel.end(130 if found else 0, "last words" if found else "")
print("-" * 20, "mpirun has something to say", file=sys.stderr)
"""


def ranks(seconds: float) -> list[str]:
    return [sys.executable, SCRIPT, sys.executable, "-c", RANK, str(seconds)]


def output(command: list[str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, env=environment(), cwd=ROOT, capture_output=True, text=True, timeout=60
    )


def test_status_and_lines_are_the_ranks_and_mpiruns_own_words_are_left_out() -> None:
    done = output(ranks(0.1))
    assert done.stdout.splitlines() == ["ready", "found []", "told 0, mpirun 0, signal 0"]
    assert done.stderr == ""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_reaches_the_ranks_as_it_is(number: signal.Signals) -> None:
    with subprocess.Popen(
        ranks(30),
        env=environment(),
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        process.send_signal(number)
        out, err = process.communicate(timeout=20)
    assert out.splitlines() == [
        f"stopping ({number.name} received); --resume will go on from here",
        f"found ['{number.name}']",
        f"told 130, mpirun 0, signal {int(number)}",
    ]
    assert err == "last words\n"


def test_a_launcher_that_is_killed_leaves_no_rank_behind(tmp_path: Path) -> None:
    mark = tmp_path / "ended"
    # Its standard error is broken by then.
    program = RANK.replace("print(", f"open({str(mark)!r}, 'w').write(repr(found))\n#")
    command = [sys.executable, SCRIPT, sys.executable, "-c", program, "30"]
    with subprocess.Popen(
        command, env=environment(), cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        process.kill()
    end = monotonic() + 10
    while not (mark.exists() and mark.read_text()):
        assert monotonic() < end
    assert mark.read_text() == repr([int(signal.SIGTERM)])


def test_a_terminal_shows_a_moving_bar_and_ctrl_c_leaves_a_clean_prompt() -> None:
    status, seen = in_terminal(ranks(30), ROOT, environment(), once("0:02 so far", CTRL_C))
    assert status == 0
    assert seen.lines() == [
        "ready",
        "stopping (SIGINT received); --resume will go on from here",
        "found ['SIGINT']",
        "last words",
        "told 130, mpirun 0, signal 2",
        "",
    ]
    assert seen.text.count("1/5 done, 1 running") >= 3
    assert seen.largest_gap < 2.5


def test_ctrl_z_pauses_the_ranks_and_they_go_on_with_the_launcher() -> None:
    pressed: list[str] = []

    def press(terminal: Terminal) -> None:
        if "ready" in terminal.text and not pressed:
            pressed.append("z")
            terminal.type(CTRL_Z)
            # Until it is stopped, itself and its children.
            stopped = os.waitpid(terminal.process, os.WUNTRACED)[1]
            assert os.WIFSTOPPED(stopped)
            children = Path(f"/proc/{terminal.process}/task/{terminal.process}/children")
            rank = Path(f"/proc/{children.read_text().split()[0]}/stat")
            end = monotonic() + 10
            while rank.read_text().rpartition(")")[2].split()[0] != "T":
                assert monotonic() < end
            os.kill(terminal.process, signal.SIGCONT)

    status, seen = in_terminal(ranks(1.0), ROOT, environment(), press)
    assert status == 0
    assert pressed == ["z"]
    assert "told 0, mpirun 0, signal 0" in seen.lines()


def test_what_ends_without_a_word_is_told_by_mpiruns_status() -> None:
    done = output([sys.executable, SCRIPT, "sh", "-c", "echo trouble >&2; echo half; exit 7"])
    assert done.stdout.splitlines() == ["half", "told None, mpirun 7, signal 0"]
    assert done.stderr == "trouble\n"


def test_a_stop_before_the_ranks_are_there_ends_mpirun() -> None:
    command = [sys.executable, SCRIPT, "sh", "-c", "echo slow start; exec sleep 30"]
    status, seen = in_terminal(command, ROOT, environment(), once("slow start", CTRL_C))
    assert status == 0
    words = f"told None, mpirun {-signal.SIGUSR1}, signal {int(signal.SIGINT)}"
    assert seen.lines()[-2].endswith(words)
