"""A launcher of stand-ins for ranks: ``python launcher_script.py MPIRUN [ARGUMENTS]``."""

import sys

from pearlite_petsc.launch.display import Display, is_terminal
from pearlite_petsc.launch.launcher import Launcher

with Display(terminal=is_terminal(sys.stdout)) as display:
    told, own, stop = Launcher(sys.argv[1:], display).run()
sys.stdout.write(f"told {told}, mpirun {own}, signal {stop}\n")
