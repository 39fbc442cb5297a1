"""Command: grow the cracks of a scene on all ranks and leave curves, pictures and ParaView files.

``mpirun -n RANKS pearlite run [SCENE.toml] [-- PETSc options]``
"""

import argparse
import json
import logging
import os
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from time import monotonic

import pearlite_petsc
from pearlite_petsc.command_line import (
    CommandParser,
    add_output_option,
    add_set_option,
    complain,
    expected_ranks,
    given_arguments,
    say,
)
from pearlite_petsc.config import load_scene, load_scene_text, scene_schema
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.output.experiment import read_experiment
from pearlite_petsc.output.results import read_results
from pearlite_petsc.scene import Scene
from pearlite_petsc.world import world

_EXAMPLES = """examples:
  mpirun -n 2 pearlite run                         the quickstart on two ranks
  mpirun -n 8 pearlite run runs/paper.toml --resume
  pearlite run my.toml --set loading.delta_k_mpa_sqrt_m=[10,20] --dry-run
  pearlite run runs/quickstart/results.h5 --output runs/again
  pearlite run my.toml -- -log_view -ksp_type cg -pc_type cholesky

Without mpirun (or srun) it runs on one rank; cracks are shared out among the ranks there are.
Units: lengths in um, Delta-K in MPa sqrt(m), stresses in MPa; the key's name ends in its unit.
Exit status: 0 done, 1 error or output not writable, 2 bad input (nothing written), 3 some tasks
failed, 130 stopped by a signal or the wall time; --resume goes on from there.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit status."""
    started = monotonic()
    given = given_arguments(arguments)
    cut = given.index("--") if "--" in given else len(given)
    own, petsc = given[:cut], given[cut + 1 :]
    chosen = _parser().parse_args(own)
    if chosen.schema:
        say(json.dumps(scene_schema(), indent=2))
        return ExitStatus.DONE
    try:
        scene = _scene(chosen)
        _check_options(chosen, petsc)
    except SceneError as error:
        complain(str(error))
        return ExitStatus.BAD_INPUT
    folder = chosen.output or Path("runs") / scene.name
    if chosen.dry_run:
        from pearlite_petsc.ensemble.estimate import dry_run_text

        say(dry_run_text(scene, folder, expected_ranks()))
        return ExitStatus.DONE
    return _start(chosen, scene, folder, petsc, ["pearlite_petsc.run", *given], started)


def _start(
    chosen: argparse.Namespace,
    scene: Scene,
    folder: Path,
    petsc: Sequence[str],
    command: Sequence[str],
    started: float,
) -> int:
    """Start MPI and PETSc and run; an unexpected error ends all ranks."""
    ranks = world()
    try:
        from pearlite_petsc.solver.initialize import initialize_petsc

        # Whatever imports PETSc first starts it, so this comes before all that computes.
        initialize_petsc(petsc)
        from pearlite_petsc.ensemble.session import Session, Settings

        settings = Settings(
            folder,
            chosen.resume,
            chosen.overwrite,
            chosen.retry_failed,
            chosen.checkpoint_interval,
            chosen.max_walltime,
            tuple(command),
        )
        return Session(ranks, scene, settings, started, _on_terminal()).run()
    except SceneError as error:
        # Raised on all ranks alike.
        if ranks.rank == 0:
            sys.stderr.write(f"{error}\n")
        return ExitStatus.BAD_INPUT
    except BaseException as error:
        if isinstance(error, PearliteError):
            sys.stderr.write(f"{error}\n")
        else:
            traceback.print_exc()
        logging.getLogger(__name__).exception("unexpected error")
        if ranks.size > 1:
            sys.stderr.flush()
            ranks.Abort(ExitStatus.BROKEN)
        return ExitStatus.BROKEN


def _scene(chosen: argparse.Namespace) -> Scene:
    """Return the scene of a TOML file, of a ``results.h5`` or the default one, fully checked."""
    overrides = list(chosen.set)
    if chosen.ranks_per_task is not None:
        overrides.append(f"ensemble.ranks_per_task={chosen.ranks_per_task}")
    path = chosen.scene
    if path is None:
        path = Path(pearlite_petsc.__file__).parents[1] / "runs" / "quickstart.toml"
        if not path.is_file():
            # Installed without the scene files: what is left out takes the quickstart's value.
            scene = load_scene_text('name = "quickstart"', "quickstart", overrides)
            return _with_experiment(scene)
    if path.suffix in (".h5", ".hdf5"):
        if not path.is_file():
            raise SceneError(f"{path}: no such file")
        text = read_results(path).scene_text
        return _with_experiment(load_scene_text(text, str(path), overrides))
    return _with_experiment(load_scene(path, overrides))


def _with_experiment(scene: Scene) -> Scene:
    if scene.output.experiment is not None:
        states = [state.name for state in scene.states]
        read_experiment(Path(scene.output.experiment), states)
    return scene


def _check_options(chosen: argparse.Namespace, petsc: Sequence[str]) -> None:
    if chosen.resume and chosen.overwrite:
        raise SceneError("--resume and --overwrite exclude each other")
    if chosen.retry_failed and not chosen.resume:
        raise SceneError("--retry-failed needs --resume")
    for name in ("checkpoint_interval", "max_walltime"):
        value = getattr(chosen, name)
        if value is not None and not value >= 0.0:
            raise SceneError(f"--{name.replace('_', '-')} {value:g} is not a time in seconds")
    if petsc and not petsc[0].startswith("-"):
        raise SceneError(f"-- {petsc[0]}: PETSc options start with -")


def _parser() -> argparse.ArgumentParser:
    parser = CommandParser(
        "run",
        "Grow the fatigue cracks of a scene; on several ranks with mpirun or srun.",
        _EXAMPLES,
        usage="%(prog)s [SCENE.toml | results.h5] [options] [-- PETSc options]",
    )
    add = parser.add_argument
    add("scene", nargs="?", type=Path, metavar="SCENE", help="scene; default runs/quickstart.toml")
    add_output_option(parser, "output folder; default runs/<scene>")
    add_set_option(parser)
    add("--resume", action="store_true", help="go on with what is in the output folder")
    add("--retry-failed", action="store_true", help="with --resume: failed tasks once more")
    add("--overwrite", action="store_true", help="remove what an earlier run left there")
    add("--dry-run", action="store_true", help="print scene, size, memory and expected time only")
    add("--schema", action="store_true", help="print the JSON schema of scene files")
    add("--ranks-per-task", type=int, metavar="N", help="ranks that share a crack; default 1")
    add(
        "--checkpoint-interval",
        type=float,
        default=30.0,
        metavar="S",
        help="seconds between checkpoints of a growing crack; default 30",
    )
    add("--max-walltime", type=float, metavar="S", help="stop cleanly after so many seconds")
    return parser


def _on_terminal() -> bool:
    """Return whether a user looks at standard output; Open MPI shows its ranks a false terminal."""
    if "OMPI_COMM_WORLD_RANK" in os.environ:
        try:
            return os.readlink(f"/proc/{os.getppid()}/fd/1").startswith(("/dev/pts/", "/dev/tty"))
        except OSError:
            return False
    return sys.stdout.isatty()


if __name__ == "__main__":
    sys.exit(main())
