"""``run --ranks N``: the launcher of a run, which starts it with ``mpirun`` and says how it ended."""

import shutil
import signal
import sys
from collections.abc import Sequence
from pathlib import Path

from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.launch.display import Display, Standing, is_terminal
from pearlite_petsc.launch.launcher import Launcher


def launch_run(arguments: Sequence[str], ranks: int, folder: Path) -> int:
    """Run ``python -m pearlite_petsc.run ARGUMENTS`` on some ranks; return its exit status.

    Args:
        arguments: Checked arguments of the command.
        ranks: Number of ranks.
        folder: Output folder, for messages.
    """
    starter = shutil.which("mpirun") or shutil.which("mpiexec")
    if starter is None:
        return _complain("mpirun is not found: install an MPI, or leave out --ranks")
    program = [sys.executable, "-m", "pearlite_petsc.run", *arguments]
    display = Display(terminal=is_terminal(sys.stdout))
    with display:
        display.stand(Standing(f"starting {ranks} rank(s)"))
        try:
            told, own, stop = Launcher([starter, "-n", str(ranks), *program], display).run()
        except OSError as error:
            return _complain(f"{starter} cannot be started: {error.strerror}")
    if told is not None:
        return told
    if stop:
        display.line(
            f"stopped ({signal.Signals(stop).name} received) before the ranks were ready; --resume goes on"
        )
        return ExitStatus.INTERRUPTED
    how = f"by signal {-own}" if own < 0 else f"with status {own}"
    return _complain(
        f"mpirun ended {how} and the ranks did not say why; {folder / 'run.log'} may say more, and "
        "--resume continues with what is finished"
    )


def _complain(text: str) -> int:
    sys.stderr.write(f"pearlite: {text}\n")
    return ExitStatus.BROKEN
