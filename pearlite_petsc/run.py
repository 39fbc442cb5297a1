"""Command: grow the cracks of a scene on all ranks and leave curves, pictures and ParaView files.

``pearlite run [--ranks N] [SCENE.toml] [-- PETSc options]``
"""

import argparse
import json
import sys
import traceback
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

import pearlite_petsc
from pearlite_petsc.command_line import (
    complain,
    expected_ranks,
    given_arguments,
    is_first_rank,
    say,
)
from pearlite_petsc.config import (
    find_laws,
    load_scene,
    load_scene_text,
    refuse_faulty_laws,
    scene_schema,
)
from pearlite_petsc.ensemble.folder import find_earlier_run
from pearlite_petsc.ensemble.stop import StopRequest
from pearlite_petsc.ensemble.tasks import refuse_few_ranks
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.launch.channel import Channel
from pearlite_petsc.launch.display import Screen, Standing, display_of_rank, started_by_mpi
from pearlite_petsc.launch.libraries import missing_libraries, unusable_library
from pearlite_petsc.launch.mpirun import launch_run
from pearlite_petsc.output.experiment import KEPT, Experiment, parse_experiment, read_experiment
from pearlite_petsc.output.results import read_results
from pearlite_petsc.run_options import parse_run
from pearlite_petsc.scene import Scene
from pearlite_petsc.world import world

if TYPE_CHECKING:
    from mpi4py import MPI


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit status."""
    started = monotonic()
    given = given_arguments(arguments)
    chosen, petsc = parse_run(given)
    if chosen.schema:
        return _schema(chosen)
    try:
        scene, experiment = _scene(chosen)
        refuse_faulty_laws(scene)
    except SceneError as error:
        return _refused(str(error), together=not chosen.dry_run)
    folder = chosen.output or Path("runs") / scene.name
    if chosen.dry_run:
        from pearlite_petsc.ensemble.estimate import dry_run_text

        say(dry_run_text(scene, folder, chosen.ranks or expected_ranks()))
        return ExitStatus.DONE
    missing = missing_libraries()
    if missing:
        complain(missing)
        return ExitStatus.BROKEN
    if chosen.ranks is not None and not started_by_mpi():
        try:
            refuse_few_ranks(scene, chosen.ranks)
            find_earlier_run(folder, scene, chosen.resume, chosen.overwrite)
        except SceneError as error:
            complain(str(error))
            return ExitStatus.BAD_INPUT
        return launch_run(given, chosen.ranks, folder)
    if experiment is not None:
        # The output folder keeps a copy: what is in it must not hang on a file elsewhere.
        scene = replace(scene, output=replace(scene.output, experiment=KEPT))
    command = ["pearlite", "run", *given]
    return _start(chosen, scene, experiment, folder, petsc, command, started)


def _refused(text: str, together: bool) -> int:
    """Say why the input cannot be used, once for all ranks; return the exit status.

    Args:
        text: What this rank found.
        together: Whether ranks that found nothing wrong wait for the others to agree.
    """
    alone = not started_by_mpi() or expected_ranks() < 2
    if alone or not together or missing_libraries():
        complain(text)
        return ExitStatus.BAD_INPUT
    with ExitStack() as stack:
        channel = Channel.connect()
        screen: Screen = channel or stack.enter_context(display_of_rank())
        ranks = world()
        first = _first_refusal(ranks, text)
        return _end(channel, screen, ExitStatus.BAD_INPUT, first, ranks.rank == 0)


def _first_refusal(ranks: "MPI.Comm", text: str = "") -> str:
    """Return what the first rank that found something wrong says, "" if none did. Collective."""
    return next((found for found in ranks.allgather(text) if found), "")


def _start(
    chosen: argparse.Namespace,
    scene: Scene,
    experiment: Experiment | None,
    folder: Path,
    petsc: Sequence[str],
    command: Sequence[str],
    started: float,
) -> int:
    """Be one rank of the run; return its exit status."""
    with ExitStack() as stack:
        # First, so that a signal is remembered from here on, whatever it comes into.
        request = stack.enter_context(StopRequest(chosen.max_walltime, started))
        channel = Channel.connect()
        screen: Screen = channel or stack.enter_context(display_of_rank())
        if is_first_rank():
            request.tell = screen.stopping
            screen.stand(Standing("starting MPI and PETSc"))
        try:
            ranks = world()
            refusal = _first_refusal(ranks)
            if refusal:
                return _end(channel, screen, ExitStatus.BAD_INPUT, refusal, ranks.rank == 0)
            from pearlite_petsc.solver.initialize import initialize_petsc

            # Whatever imports PETSc first starts it, so this comes before all that computes.
            initialize_petsc(petsc)
        except (ImportError, ValueError) as error:
            # numpy's is a ValueError where it is not the one that petsc4py was built for.
            text = unusable_library(error)
            return _end(channel, screen, ExitStatus.BROKEN, text, is_first_rank())
        try:
            from pearlite_petsc.ensemble.session import Session, Settings

            settings = Settings(
                folder,
                chosen.resume,
                chosen.overwrite,
                chosen.retry_failed,
                chosen.checkpoint_interval,
                tuple(command),
                experiment,
            )
            status = Session(ranks, scene, settings, started, request, screen).run()
            return _end(channel, screen, status, "", ranks.rank == 0)
        except SceneError as error:
            # Raised on all ranks alike.
            return _end(channel, screen, ExitStatus.BAD_INPUT, str(error), ranks.rank == 0)
        except BaseException as error:
            status = _end(channel, screen, ExitStatus.BROKEN, _last_words(error, ranks.rank), True)
            if ranks.size > 1:
                ranks.Abort(ExitStatus.BROKEN)
            return status


def _end(channel: Channel | None, screen: Screen, status: int, text: str, speaks: bool) -> int:
    """Tell how the run ended; return this rank's exit status, 0 where the launcher gives it."""
    if channel is None:
        if text and speaks:
            screen.trouble(text)
        return status
    if speaks:
        channel.end(status, text)
    # mpirun would have a good deal to say about any other.
    return ExitStatus.DONE


def _last_words(error: BaseException, rank: int) -> str:
    if isinstance(error, PearliteError):
        return str(error)
    trace = "".join(traceback.format_exception(error))
    return (
        f"{trace}pearlite: an error of the program on rank {rank} ended the run "
        f"({type(error).__name__}); what is finished is kept, --resume goes on"
    )


def _scene(chosen: argparse.Namespace) -> tuple[Scene, Experiment | None]:
    """Return the scene of a TOML file, of a ``results.h5`` or the default one, fully checked.

    With it come the measured points that it names; those of a ``results.h5`` are in it.
    """
    overrides = list(chosen.set)
    if chosen.ranks_per_task is not None:
        overrides.append(f"ensemble.ranks_per_task={chosen.ranks_per_task}")
    path, laws = chosen.scene, find_laws(chosen.load)
    if path is None:
        path = Path(pearlite_petsc.__file__).parents[1] / "runs" / "quickstart.toml"
        if not path.is_file():
            # Installed without the scene files: what is left out takes the quickstart's value.
            scene = load_scene_text('name = "quickstart"', "quickstart", overrides, laws)
            return _with_experiment(scene)
    if path.suffix in (".h5", ".hdf5"):
        if not path.is_file():
            raise SceneError(f"{path}: no such file")
        stored = read_results(path)
        scene = load_scene_text(stored.scene_text, str(path), overrides, laws)
        own = not any(text.startswith("output.experiment") for text in overrides)
        return _with_experiment(scene, stored.experiment_text if own else None)
    return _with_experiment(load_scene(path, overrides, laws))


def _with_experiment(scene: Scene, text: str | None = None) -> tuple[Scene, Experiment | None]:
    states = [state.name for state in scene.states]
    if text is not None:
        return scene, parse_experiment(text, KEPT, states)
    name = scene.output.experiment
    return scene, None if name is None else read_experiment(Path(name), states)


def _schema(chosen: argparse.Namespace) -> int:
    """Print the JSON schema of scene files."""
    try:
        schema = scene_schema(find_laws(chosen.load))
    except SceneError as error:
        complain(str(error))
        return ExitStatus.BAD_INPUT
    say(json.dumps(schema, indent=2))
    return ExitStatus.DONE


if __name__ == "__main__":
    sys.exit(main())
