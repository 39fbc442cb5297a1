"""What a group does until no task is open: takes one, grows its crack, writes what came out."""

import logging
from collections import OrderedDict
from collections.abc import Sequence
from functools import partial

import numpy as np

from pearlite_petsc.ensemble.board import Board
from pearlite_petsc.ensemble.crack import Ground, NotWritableError, failed, grow_task, write
from pearlite_petsc.ensemble.expected import Forecast
from pearlite_petsc.ensemble.schedule import next_task
from pearlite_petsc.ensemble.status import Status, status_of, values_of
from pearlite_petsc.ensemble.stop import StoppedError, left_when
from pearlite_petsc.ensemble.store import mesh_hash
from pearlite_petsc.ensemble.tasks import Task
from pearlite_petsc.ensemble.trouble import tell_not_writable
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.growth.prepared import Prepared, prepare_growth
from pearlite_petsc.growth.ranks import on_first_rank
from pearlite_petsc.growth.shared_domain import SharedDomain
from pearlite_petsc.launch.display import Screen
from pearlite_petsc.output.tables import write_growth

_log = logging.getLogger(__name__)

MESHES_AT_HAND = 2
"""Microstructures that a group keeps: the one it works on and the one before."""


class Worker:
    """One group at work. All methods are collective over the group.

    Args:
        ground: What all tasks of the group share.
        tasks: All tasks of the scene.
        board: Status of all tasks.
        forecast: Expected wall times.
        screen: What the user sees.
    """

    def __init__(
        self,
        ground: Ground,
        tasks: Sequence[Task],
        board: Board,
        forecast: Forecast,
        screen: Screen,
    ) -> None:
        self._ground, self._tasks, self._board = ground, tasks, board
        self._forecast, self._screen = forecast, screen
        self._microstructure = np.array([task.microstructure for task in tasks])
        self._at_hand: OrderedDict[int, tuple[Prepared, str] | Exception] = OrderedDict()
        self._shared_domain = SharedDomain(ground.group.comm, ground.scene)

    def work(self) -> None:
        """Take and finish tasks until none is open or a stop is wanted."""
        self._take_tasks()
        self._shared_domain.close()

    def _take_tasks(self) -> None:
        group = self._ground.group
        while not group.any_of(self._ground.stopping()):
            number = on_first_rank(group.comm, self._claim, to_all=True)
            if number is None:
                return
            task = self._tasks[number]
            try:
                outcome, mesh = self._grow(task)
                if outcome is not None:
                    write(group, partial(self._keep, task, outcome, mesh))
                    continue
            except NotWritableError as error:
                if group.first:
                    tell_not_writable(self._board, self._screen, error)
            except StoppedError:
                # Left in the middle of a mesh; the crack's last checkpoint stays.
                pass
            if group.first:
                self._board.release(number)

    def _claim(self) -> int | None:
        while True:
            status = self._board.status()
            expected = self._forecast.seconds(status, self._board.values())
            number = next_task(
                status == Status.OPEN,
                status == Status.RUNNING,
                self._microstructure,
                expected,
                self._at_hand.keys(),
            )
            if number is None or self._board.claim(number):
                return number

    def _grow(self, task: Task) -> tuple[Outcome | None, str]:
        group = self._ground.group
        try:
            prepared, mesh = on_first_rank(group.comm, partial(self._prepare, task)) or (None, "")
        except StoppedError:
            raise
        except Exception as error:
            return failed(task, error), ""
        return grow_task(self._ground, task, prepared, mesh, self._shared_domain), mesh

    def _prepare(self, task: Task) -> tuple[Prepared, str]:
        """Return the microstructure of a task, made once for all its delta_k; first rank only."""
        number, known = task.microstructure, self._at_hand
        if number not in known:
            try:
                with left_when(self._ground.stopping):
                    prepared = prepare_growth(self._ground.scene, task.state, task.mesh_index)
                known[number] = prepared, mesh_hash(prepared.mesh)
            except StoppedError:
                raise
            except Exception as error:
                known[number] = error
        known.move_to_end(number)
        while len(known) > MESHES_AT_HAND:
            known.popitem(last=False)
        found = known[number]
        if isinstance(found, Exception):
            raise found
        return found

    def _keep(self, task: Task, outcome: Outcome, mesh: str) -> None:
        """Write an outcome and enter it on the board; first rank only."""
        write_growth(self._ground.folder / "growth", outcome)
        self._ground.store.write_finished(task, outcome, mesh)
        if outcome.stop_reason is StopReason.FAILED:
            _log.error("%s failed: %s", task.name, outcome.message.rstrip())
        self._board.finish(task.number, status_of(outcome), values_of(outcome))
