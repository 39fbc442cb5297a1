"""One run from the output folder to the report: what the command does once MPI is there."""

import logging
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from resource import RUSAGE_SELF, getrusage
from time import monotonic
from typing import Any

import numpy as np
from mpi4py import MPI

from pearlite_petsc.config import laws_of_scene, method_warnings, scene_hash
from pearlite_petsc.ensemble.campaign import Campaign, Found, look_back
from pearlite_petsc.ensemble.drawing import draw_and_report
from pearlite_petsc.ensemble.folder import OutputFolder
from pearlite_petsc.ensemble.products import Products
from pearlite_petsc.ensemble.status import Status
from pearlite_petsc.ensemble.stop import NOT_WRITABLE, StopRequest, describe
from pearlite_petsc.ensemble.tasks import refuse_few_ranks
from pearlite_petsc.errors import SceneError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.growth.ranks import on_first_rank
from pearlite_petsc.launch.display import Screen, Standing, clock
from pearlite_petsc.output.experiment import Experiment
from pearlite_petsc.output.provenance import ended_now, provenance
from pearlite_petsc.scene import Scene
from pearlite_petsc.solver.petsc_build import petsc_facts
from pearlite_petsc.solver.unused import unused_options, unused_text

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Settings:
    """What the command line says beside the scene.

    Attributes:
        folder: Output folder.
        resume, overwrite, retry_failed: What to do with what is there.
        interval: Seconds between checkpoints of a crack.
        command: Command line as given.
        experiment: Measured points to be kept and drawn, None for none.
    """

    folder: Path
    resume: bool
    overwrite: bool
    retry_failed: bool
    interval: float
    command: tuple[str, ...]
    experiment: Experiment | None = None


class Session:
    """Runs a scene on all ranks. Collective.

    Args:
        world: All ranks.
        scene: The scene.
        settings: The command line.
        started: When the program started, by ``time.monotonic``.
        request: Signals and wall time of this rank.
        screen: What the user sees.
    """

    def __init__(
        self,
        world: MPI.Comm,
        scene: Scene,
        settings: Settings,
        started: float,
        request: StopRequest,
        screen: Screen,
    ) -> None:
        self._world, self._scene, self._settings = world, scene, settings
        self._started, self._request, self._screen = started, request, screen
        self._first = world.rank == 0
        self._before = 0
        self._facts: dict[str, Any] = {}
        self._began = datetime.now().astimezone()

    def run(self) -> int:
        """Return the exit status.

        Raises:
            SceneError: The output folder or what is in it cannot be used; on all ranks.
        """
        scene, settings, world = self._scene, self._settings, self._world
        refuse_few_ranks(scene, world.size)
        self._refuse_different_scenes()
        with ExitStack() as stack:
            output = on_first_rank(
                world,
                lambda: OutputFolder(
                    settings.folder,
                    scene,
                    settings.resume,
                    settings.overwrite,
                    None if settings.experiment is None else settings.experiment.text,
                ),
            )
            if output is not None:
                stack.callback(output.close)
            stack.enter_context(logging_to(settings.folder, world.rank))
            found = on_first_rank(
                world, lambda: look_back(settings.folder, scene, settings.retry_failed)
            )
            if found is not None and output is not None:
                self._before = sum(s in (Status.DONE, Status.FAILED) for s in found.status)
                self._announce(found, output.resumed)
            products = None
            if self._first:
                products = Products(settings.folder, scene, settings.experiment, self._provenance)
            campaign = Campaign(
                world,
                scene,
                settings.folder,
                found,
                settings.interval,
                self._request,
                self._screen,
                products,
            )
            stack.callback(campaign.close)
            return self._finish(campaign, campaign.run(), products)

    def _finish(
        self, campaign: Campaign, counts: tuple[int, int, int], products: Products | None
    ) -> int:
        """Write what there is and return the exit status."""
        done, failed, missing = counts
        stop = campaign.stop_code()
        folder = self._settings.folder
        memory = self._world.allreduce(getrusage(RUSAGE_SELF).ru_maxrss / 1024.0, MPI.MAX)
        facts = {
            "growth_s": round(campaign.seconds, 3),
            "busy_share": round(campaign.busy_share, 4),
            "largest_memory_of_a_rank_mb": round(memory, 1),
        }
        written, complete = True, products is not None and products.are_complete(done + failed)
        if products is not None and not complete:
            self._screen.stand(Standing("writing the results"))
            try:
                products.write_all(facts)
            except (OSError, RuntimeError) as error:
                _log.error("the results cannot be written: %s", error)
                if stop != NOT_WRITABLE:
                    self._screen.trouble(f"the output cannot be written: {error}")
                written = False
        written, complete = self._world.bcast((written, complete))
        drawn, shown = True, folder / "report.html" if complete else folder
        if written and not complete and not stop and self._scene.output.figures:
            drawn = draw_and_report(
                self._world,
                folder,
                self._scene,
                self._settings.experiment,
                self._request.code,
                self._screen,
            )
            stop = self._world.allreduce(self._request.code(), MPI.MAX)
            shown = folder / "report.html"
        has_grown = self._world.bcast(done + failed > self._before)
        unused = self._unused_options() if has_grown else []
        summary = f"{done} done, {failed} failed, {missing} missing"
        if stop:
            summary = f"stopped ({describe(stop)}): {summary}; --resume goes on"
        self._say(f"{summary}; {clock(monotonic() - self._started)}; {shown}")
        if not written or not drawn or stop == NOT_WRITABLE:
            return ExitStatus.BROKEN
        if stop:
            return ExitStatus.INTERRUPTED
        if unused:
            return ExitStatus.BROKEN
        return ExitStatus.SOME_FAILED if failed else ExitStatus.DONE

    def _unused_options(self) -> list[str]:
        """Name the PETSc options that nothing used on any rank. Collective."""
        every = self._world.allgather(unused_options())
        names = [name for name in every[0] if all(name in other for other in every)]
        if names and self._first:
            self._screen.trouble(unused_text(names))
            _log.error("%s", unused_text(names))
        return names

    def _announce(self, found: Found, resumed: bool) -> None:
        status = np.array(found.status)
        done, failed = int((status == Status.DONE).sum()), int((status == Status.FAILED).sum())
        missing = len(status) - done - failed
        if resumed:
            self._say(
                f"going on: {done} of {len(status)} tasks done, {failed} failed, {missing} missing, "
                f"of which {found.growing} with a checkpoint"
            )
        else:
            each = self._scene.ensemble.ranks_per_task
            left_over = self._world.size % each
            ranks = f"{self._world.size} rank(s), {each} a task"
            ranks += f" ({left_over} left over)" if left_over else ""
            self._say(f"{self._scene.name}: {len(status)} tasks on {ranks}")
        experiment = self._settings.experiment
        for text in () if experiment is None else experiment.notes:
            self._say(f"note: {text}")
        for text in method_warnings(self._scene):
            self._say(f"note: {text}")

    def _provenance(self) -> dict[str, Any]:
        if self._facts:
            return ended_now(self._facts)
        facts = petsc_facts()
        mpi = MPI.Get_library_version().split("\n")[0].rstrip("\0")
        found = provenance(
            self._settings.command,
            self._began,
            datetime.now().astimezone(),
            {"microstructure": self._scene.microstructure.seed},
            {**facts, "mpi": mpi},
            self._world.size,
        )
        # Once: the source may change while the run goes on, and git takes its time.
        self._facts = found | {"laws": laws_of_scene(self._scene)}
        return self._facts

    def _refuse_different_scenes(self) -> None:
        """Check that all ranks have read the same files. Collective.

        Raises:
            SceneError: They have not; on all ranks.
        """
        hashes = self._world.allgather(scene_hash(self._scene))
        other = next((rank for rank, found in enumerate(hashes) if found != hashes[0]), 0)
        if other:
            raise SceneError(
                f"rank {other} has read another scene or another text of a law than rank 0: "
                "the files must be the same on all machines"
            )

    def _say(self, text: str) -> None:
        if self._first:
            self._screen.line(text)
            _log.info("%s", text)


class _LogFile(logging.FileHandler):
    """A log whose own troubles (a full disk) are not the user's."""

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802
        """Lose the record."""


@contextmanager
def logging_to(folder: Path, rank: int) -> Iterator[None]:
    """Log into ``run.log``, other ranks their warnings into ``run.<rank>.log``."""
    name = "run.log" if rank == 0 else f"run.{rank}.log"
    handler = _LogFile(folder / name, delay=rank > 0, encoding="utf-8")
    handler.setLevel(logging.INFO if rank == 0 else logging.WARNING)
    form = "%(asctime)s %(levelname)s %(name)s: %(message)s"
    handler.setFormatter(logging.Formatter(form))
    logger = logging.getLogger("pearlite_petsc")
    level = logger.level
    logger.setLevel(logging.INFO)
    logger.addHandler(handler)
    try:
        yield
    except BaseException:
        logger.exception("the run ends with an error")
        raise
    finally:
        logger.setLevel(level)
        logger.removeHandler(handler)
        with suppress(OSError):
            handler.close()
