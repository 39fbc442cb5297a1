"""One task on the ranks of a group: grows the crack and keeps its checkpoints."""

import traceback
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from enum import IntFlag
from functools import partial
from pathlib import Path
from time import monotonic, perf_counter

from pearlite_petsc.ensemble.fields import FieldObserver
from pearlite_petsc.ensemble.group import Group
from pearlite_petsc.ensemble.store import Store
from pearlite_petsc.ensemble.tasks import Task
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.fatigue.outcome import Effort, Outcome, StopReason
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import Prepared
from pearlite_petsc.growth.ranks import on_first_rank
from pearlite_petsc.growth.shared_domain import SharedDomain
from pearlite_petsc.scene import Scene


class Wish(IntFlag):
    """What a rank wants between two steps; the group does what any of them wants."""

    NOTHING = 0
    CHECKPOINT = 1
    STOP = 2


class NotWritableError(PearliteError):
    """The output folder cannot be written."""


@dataclass(frozen=True, slots=True)
class Ground:
    """What all tasks of a group share.

    Attributes:
        group: The ranks.
        scene: The scene.
        folder: The output folder.
        store: Checkpoints and finished tasks.
        interval: Seconds between checkpoints.
        stopping: Called between steps: whether to stop; also serves the other groups.
    """

    group: Group
    scene: Scene
    folder: Path
    store: Store
    interval: float
    stopping: Callable[[], bool]


def grow_task(
    ground: Ground, task: Task, prepared: Prepared | None, mesh: str, shared: SharedDomain
) -> Outcome | None:
    """Return the outcome of a task on all ranks, None if it was stopped before its end. Collective.

    What goes wrong in the task is an outcome with the error's message and traceback.

    Args:
        ground: What all tasks of the group share.
        task: The crack.
        prepared: Its microstructure on the group's first rank, None elsewhere.
        mesh: Hash of its first mesh.
        shared: Gives the domain of that mesh.

    Raises:
        NotWritableError: The output folder cannot be written; on all ranks.
    """
    started = perf_counter()
    # What must be closed is closed together, after the ranks have agreed on what happened.
    with ExitStack() as stack:
        try:
            return _grow(ground, task, prepared, mesh, shared, stack)
        except NotWritableError:
            raise
        except Exception as error:
            ground.group.agree_on_failure(error)
            # What failed may have left it in any state.
            stack.callback(shared.close)
            return failed(task, error, perf_counter() - started)


def failed(task: Task, error: BaseException, wall_s: float = 0.0) -> Outcome:
    """Return the outcome of a task that failed; after its first line the message is the traceback."""
    trace = "".join(traceback.format_exception(error))
    return Outcome(
        state=task.state.name,
        mesh_index=task.mesh_index,
        delta_k=task.delta_k,
        stop_reason=StopReason.FAILED,
        message=f"{type(error).__name__}: {error}\n\n{trace}",
        effort=Effort(wall_s=wall_s),
    )


def _grow(
    ground: Ground,
    task: Task,
    prepared: Prepared | None,
    mesh: str,
    shared: SharedDomain,
    stack: ExitStack,
) -> Outcome | None:
    group, scene, store = ground.group, ground.scene, ground.store
    stored = on_first_rank(group.comm, lambda: store.read_checkpoint(task, mesh))
    checkpoint, states = (None, []) if stored is None else stored
    resumes = group.same(checkpoint is not None)
    domain = None if resumes else shared.domain(task.microstructure, prepared)
    growth = CrackGrowth(group.comm, scene, task.state, task.delta_k, prepared, checkpoint, domain)
    stack.callback(growth.close)
    ratio = None if prepared is None else prepared.ratio
    fields = FieldObserver(group, scene, ground.folder, task, ratio, states)
    stack.callback(fields.abandon)
    write(group, fields.open)

    def keep() -> None:
        state = growth.checkpoint()
        if state is None:
            write(group, lambda: None)
        else:
            write(group, lambda: store.write_checkpoint(task, mesh, state, fields.keep(store)))

    last_kept = monotonic()
    for step in growth.steps():
        if fields.is_due(step):
            state = growth.growth_state()
            write(group, partial(fields.add, state))
        if step.stop is not None:
            write(group, fields.close)
            return group.same(growth.outcome(step.stop))
        wish = Wish.STOP if ground.stopping() else Wish.NOTHING
        if monotonic() - last_kept >= ground.interval:
            wish |= Wish.CHECKPOINT
        wish = Wish(group.any_of(int(wish)))
        if wish:
            keep()
            last_kept = monotonic()
        if wish & Wish.STOP:
            return None
    raise AssertionError("the growth ended without a reason")


def write(group: Group, function: Callable[[], object]) -> None:
    """Call what writes a file on the group's first rank. Collective.

    Raises:
        NotWritableError: It cannot be written; on all ranks.
    """
    try:
        on_first_rank(group.comm, function)
    except (OSError, RuntimeError) as error:
        # HDF5 reports a full disk as either.
        raise NotWritableError(str(error)) from error
