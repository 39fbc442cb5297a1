"""Arguments of the run command.

It needs nothing but Python, so that ``./pearlite.sh run --help`` and a wrong option are answered
before anything is installed: ``python -m pearlite_petsc.run_options ARGUMENTS``.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from pearlite_petsc.command_line import (
    CommandParser,
    add_load_option,
    add_output_option,
    add_set_option,
)

_EXAMPLES = """examples:
  pearlite run --ranks 2                           the quickstart on two ranks
  pearlite run --ranks 8 runs/paper.toml --resume
  pearlite run runs/first_curve.toml --set loading.delta_k_mpa_sqrt_m=[10,20] --dry-run
  pearlite run runs/quickstart/results.h5 --output runs/again
  pearlite run --load my_law.py --set damage.law=my_law --output runs/my_law
  pearlite run runs/first_curve.toml --overwrite -- -log_view -ksp_type cg -pc_type cholesky
  mpirun -n 2 pearlite run                         as --ranks 2; srun and mpiexec work, too

The cracks are divided among the ranks. ./pearlite.sh run takes the same arguments and uses all cores.
Units: lengths in um, Delta-K in MPa sqrt(m), stresses in MPa; the name of a key ends in its unit.
Exit status: 0 done, 1 error or output not writable, 2 bad input (nothing written), 3 some tasks
failed, 130 stopped by a signal or --max-walltime (--resume continues).
"""


def parse_run(given: Sequence[str]) -> tuple[argparse.Namespace, list[str]]:
    """Return the command's own options and those for PETSc; leave where they are wrong.

    Args:
        given: Arguments; PETSc's follow ``--``.
    """
    cut = given.index("--") if "--" in given else len(given)
    own, petsc = given[:cut], list(given[cut + 1 :])
    parser = _parser()
    chosen = parser.parse_args(own)
    wrong = _wrong(chosen, petsc)
    if wrong:
        parser.error(wrong)
    return chosen, petsc


def _wrong(chosen: argparse.Namespace, petsc: Sequence[str]) -> str:
    """Return what is wrong with the options, "" for nothing."""
    if chosen.resume and chosen.overwrite:
        return "--resume and --overwrite cannot be combined"
    if chosen.retry_failed and not chosen.resume:
        return "--retry-failed needs --resume"
    if chosen.ranks is not None and chosen.ranks < 1:
        return f"--ranks {chosen.ranks} is not a positive whole number"
    for name in ("checkpoint_interval", "max_walltime"):
        value = getattr(chosen, name)
        if value is not None and not value >= 0.0:
            return f"--{name.replace('_', '-')} {value:g} is not a time in seconds"
    if petsc and not petsc[0].startswith("-"):
        return f"-- {petsc[0]}: PETSc options start with -"
    return ""


def _parser() -> argparse.ArgumentParser:
    parser = CommandParser(
        "run",
        "Grow the fatigue cracks of a scene, on one rank or several.",
        _EXAMPLES,
        usage="%(prog)s [SCENE.toml | results.h5] [options] [-- PETSc options]",
    )
    add = parser.add_argument
    add("scene", nargs="?", type=Path, metavar="SCENE", help="scene; default runs/quickstart.toml")
    add_output_option(parser, "output folder; default runs/<scene>")
    add_set_option(parser)
    add_load_option(parser)
    add("--resume", action="store_true", help="continue with what is in the output folder")
    add("--retry-failed", action="store_true", help="with --resume: compute failed tasks again")
    add("--overwrite", action="store_true", help="remove what an earlier run left in the folder")
    add("--dry-run", action="store_true", help="only print scene, size, memory and expected time")
    add("--schema", action="store_true", help="print the JSON schema of scene files")
    add("--ranks", type=int, metavar="N", help="start N ranks with mpirun; default: one process")
    add("--ranks-per-task", type=int, metavar="N", help="ranks that share a crack; default 1")
    add(
        "--checkpoint-interval",
        type=float,
        default=30.0,
        metavar="S",
        help="seconds between checkpoints of a growing crack; default 30",
    )
    add("--max-walltime", type=float, metavar="S", help="stop cleanly after S seconds")
    return parser


if __name__ == "__main__":
    parse_run(sys.argv[1:])
