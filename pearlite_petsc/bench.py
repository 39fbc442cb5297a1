"""Command: what each choice of method costs in time and accuracy, and where methods fail.

``python -m pearlite_petsc.bench NAME [options]``; each name is a module of
``studies.benchmarks`` with ``add_arguments(parser)`` and ``main(args)``, which returns the exit
status.
"""

import argparse
import importlib
import math
import sys
from collections.abc import Sequence
from pathlib import Path

from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.whole_file import make_folder
from pearlite_petsc.studies.benchmarks.solver import SOLVER_CASE

SUBCOMMANDS = {
    "pareto": "speed against accuracy of cracks, one choice at a time",
    "means": "geometric means over twenty meshes a state against the fine reference",
    "lefm": "speed against accuracy of K, with finite elements beside",
    "solver": "iterations, time and memory of the solver, other solvers beside",
    "jumps": "error against solves of every jump in cycles",
    "stability": "where methods fail, and how",
    "memory": "memory of a run against the number of its meshes",
    "campaign": "the cracks of a scene against the plain baseline",
}

LEAST = {"meshes": 1, "ranks": 1, "tasks": 1, "unknowns": 1000}
"""Least values of the options that are numbers."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a benchmark; return its exit status: 0, 1 a bar was missed, 2 bad input."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    if given[:1] == [SOLVER_CASE]:
        return _solver_case(*given[1:])
    parser = argparse.ArgumentParser(
        prog="python -m pearlite_petsc.bench",
        description="Measure speed, accuracy and limits of the methods.",
        epilog="\n".join(f"{name:10} {text}" for name, text in SUBCOMMANDS.items()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("name", choices=SUBCOMMANDS, help="which benchmark")
    chosen = parser.parse_args(given[:1])
    # Only the chosen one, whose libraries the others need not have.
    module = importlib.import_module(f"pearlite_petsc.studies.benchmarks.{chosen.name}")
    own = argparse.ArgumentParser(
        prog=f"python -m pearlite_petsc.bench {chosen.name}", description=module.__doc__
    )
    module.add_arguments(own)
    options = own.parse_args(given[1:])
    try:
        _check_numbers(options)
        make_folder(options.output)
        status: int = module.main(options)
    except SceneError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    return status


def _check_numbers(options: argparse.Namespace) -> None:
    for name, least in LEAST.items():
        given = getattr(options, name, None)
        for value in given if isinstance(given, list) else [given]:
            if value is not None and not least <= value < math.inf:
                raise SceneError(f"--{name} {value:g} must be a number of at least {least:g}")


def _solver_case(bodies: str, method: str, result: str) -> int:
    """Measure one method of ``bench solver`` on the ranks that were started. Collective."""
    from mpi4py import MPI

    from pearlite_petsc.studies.benchmarks.solver_case import write_case

    write_case(MPI.COMM_WORLD, Path(bodies), method, Path(result))
    return 0


if __name__ == "__main__":
    sys.exit(main())
