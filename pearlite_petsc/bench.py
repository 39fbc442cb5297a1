"""Command: what each choice of method costs in time and accuracy, and where methods fail.

``pearlite bench NAME [options]``; each name is a module of ``studies.benchmarks`` with
``add_arguments(parser)`` and ``main(args)``, which returns the exit status.
"""

import argparse
import importlib
import math
import sys
from collections.abc import Sequence
from pathlib import Path

from pearlite_petsc.command_line import (
    CommandParser,
    add_output_option,
    complain,
    given_arguments,
)
from pearlite_petsc.errors import SceneError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.output.whole_file import make_folder
from pearlite_petsc.studies.benchmarks.solver import SOLVER_CASE
from pearlite_petsc.world import world

SUBCOMMANDS = {
    "pareto": "speed against accuracy of da/dN for every choice of method",
    "widths": "da/dN over the width of the elements in the same microstructures",
    "meshes": "whether one of a thousand meshes fails",
    "means": "geometric means over twenty meshes per state against the fine reference",
    "lefm": "speed against accuracy of K, compared with finite elements",
    "solver": "iterations, time and memory of the solver, compared with other solvers",
    "jumps": "error of da/dN against solves for every cycle jump",
    "stability": "where methods fail, and how",
    "memory": "memory of a run against the number of its meshes",
    "campaign": "the cracks of a scene against the plain baseline",
}

LEAST = {"meshes": 1, "ranks": 1, "tasks": 1, "unknowns": 1000}
"""Least values of the options that are numbers."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a benchmark; return its exit status: 0, 1 a bar was missed, 2 bad input."""
    given = given_arguments(arguments)
    if given[:1] == [SOLVER_CASE]:
        return _solver_case(*given[1:])
    parser = CommandParser(
        "bench",
        "Measure speed, accuracy and limits of the methods.",
        "\n".join(f"{name:10} {text}" for name, text in SUBCOMMANDS.items()),
    )
    parser.add_argument("name", choices=SUBCOMMANDS, help="which benchmark")
    chosen = parser.parse_args(given[:1])
    # Only the chosen one, whose libraries the others need not have.
    module = importlib.import_module(f"pearlite_petsc.studies.benchmarks.{chosen.name}")
    own = CommandParser(f"bench {chosen.name}", module.__doc__ or "")
    add_output_option(own, "folder of tables and figures", Path("docs/benchmarks"))
    module.add_arguments(own)
    options = own.parse_args(given[1:])
    try:
        _check_numbers(options)
        make_folder(options.output)
        status: int = module.main(options)
    except SceneError as error:
        complain(str(error))
        return ExitStatus.BAD_INPUT
    return status


def _check_numbers(options: argparse.Namespace) -> None:
    for name, least in LEAST.items():
        given = getattr(options, name, None)
        for value in given if isinstance(given, list) else [given]:
            if value is not None and not least <= value < math.inf:
                raise SceneError(f"--{name} {value:g} must be a number of at least {least:g}")


def _solver_case(bodies: str, method: str, result: str) -> int:
    """Measure one method of ``bench solver`` on the ranks that were started. Collective."""
    from pearlite_petsc.studies.benchmarks.solver_case import write_case

    write_case(world(), Path(bodies), method, Path(result))
    return ExitStatus.DONE


if __name__ == "__main__":
    sys.exit(main())
