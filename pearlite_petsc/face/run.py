"""Whole runs from Python: every crack of a scene, with checkpoints and an output folder."""

from dataclasses import replace
from os import PathLike
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from pearlite_petsc.ensemble.stop import StopRequest
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.face.results import Results
from pearlite_petsc.face.scene import Scene
from pearlite_petsc.launch.display import display_of_rank
from pearlite_petsc.output.experiment import KEPT, read_experiment
from pearlite_petsc.output.result_folder import read_result
from pearlite_petsc.world import world

if TYPE_CHECKING:
    from mpi4py import MPI

CHECKPOINT_SECONDS = 30.0


def run(
    scene: Scene,
    output: str | PathLike[str] | None = None,
    *,
    resume: bool = False,
    overwrite: bool = False,
    comm: "MPI.Comm | None" = None,
) -> Results:
    """Grow every crack of a scene, as the command ``pearlite run`` does; return the results.

    Progress goes to standard output. The cracks are divided among the ranks; under ``mpirun`` all
    ranks of ``comm`` call this function together. A failed crack is among the results, with its
    message.

    Args:
        scene: The scene to compute.
        output: Output folder; ``runs/<name of the scene>`` if None.
        resume: Continue with what is in the folder.
        overwrite: Remove what an earlier run left in the folder.
        comm: Ranks that compute the cracks; all ranks if None.

    Raises:
        PearliteError: The folder cannot be used or written, or the run was stopped by a signal
            (``resume=True`` goes on).
    """
    started, program, experiment = monotonic(), scene._program, None
    if program.output.experiment is not None:
        experiment = read_experiment(Path(program.output.experiment), list(scene.states))
        program = replace(program, output=replace(program.output, experiment=KEPT))
    folder = Path("runs") / scene.name if output is None else Path(output)
    command = ("pearlite_petsc.run",)
    ranks = world() if comm is None else comm
    # Here, so that asking for the function starts neither MPI nor PETSc.
    from pearlite_petsc.ensemble.session import Session, Settings

    settings = Settings(folder, resume, overwrite, False, CHECKPOINT_SECONDS, command, experiment)
    with StopRequest(None, started) as request, display_of_rank() as screen:
        status = Session(ranks, program, settings, started, request, screen).run()
    if status == ExitStatus.INTERRUPTED:
        raise PearliteError(f"{folder}: the run was stopped; run(..., resume=True) continues it")
    if status == ExitStatus.BROKEN:
        raise PearliteError(
            f"{folder}: the run's output could not be written, see {folder}/run.log"
        )
    return Results(read_result(folder), scene._laws)
