"""All commands under one name: ``pearlite COMMAND`` or ``python -m pearlite_petsc COMMAND``."""

import importlib
import sys
from collections.abc import Sequence
from difflib import get_close_matches

import pearlite_petsc
from pearlite_petsc.command_line import complain, given_arguments, say
from pearlite_petsc.exit_status import ExitStatus

COMMANDS = {
    "run": "grow the cracks of a scene; --ranks N starts several ranks",
    "mesh": "make one mesh of a scene, for ParaView and Python",
    "report": "draw the figures and write the report of a run again",
    "calibrate": "fit the damage constant C to measured growth rates",
    "evaluate": "compute growth rates of a crack from its length over cycles",
    "verify": "check the claims that the program rests on",
    "check-law": "check laws of your own against what every law must fulfil",
    "bench": "measure speed, accuracy and limits of the methods",
}
"""Every command and what it does. Each is a module of its name (- becomes _) with ``main``."""

_USAGE = """usage: pearlite COMMAND [arguments]
       pearlite --version

Fatigue crack growth in sheared pearlitic rail steel by the discrete element method on PETSc.

commands:
{commands}

pearlite COMMAND --help describes a command. python -m pearlite_petsc COMMAND calls the same one."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit status; without one, list them all."""
    given = given_arguments(arguments)
    if not given or given[0] in ("-h", "--help"):
        width = max(map(len, COMMANDS))
        lines = (f"  {name:<{width}}  {what}" for name, what in COMMANDS.items())
        say(_USAGE.format(commands="\n".join(lines)))
        return ExitStatus.DONE
    name, *rest = given
    if name == "--version":
        say(f"pearlite_petsc {pearlite_petsc.__version__}")
        return ExitStatus.DONE
    if name not in COMMANDS:
        close = get_close_matches(name, COMMANDS, n=1)
        hint = f"did you mean {close[0]}?" if close else f"known are {', '.join(COMMANDS)}"
        complain(f"pearlite: {name} is not a command, {hint}")
        return ExitStatus.BAD_INPUT
    # Only the chosen one, whose libraries the others need not have.
    module = importlib.import_module(f"pearlite_petsc.{name.replace('-', '_')}")
    status: int = module.main(rest)
    return status


if __name__ == "__main__":
    sys.exit(main())
