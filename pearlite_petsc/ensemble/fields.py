"""Observer of a growing crack: chooses states for its ParaView files and keeps them for a restart."""

import logging
from pathlib import Path
from time import perf_counter

from pearlite_petsc.ensemble.group import Group
from pearlite_petsc.ensemble.store import Store
from pearlite_petsc.ensemble.tasks import Task, wants_fields
from pearlite_petsc.fatigue.outcome import GrowthState, Step
from pearlite_petsc.output.xdmf import FieldMarks, FieldSeries
from pearlite_petsc.scene import Scene

_log = logging.getLogger(__name__)


class FieldObserver:
    """Writes ``fields/<task>_*.xdmf`` on the group's first rank, if the scene wants them.

    Args:
        group: The ranks of the task.
        scene: The scene.
        folder: The output folder.
        task: The crack.
        ratio: k_t/k_n of ``matched`` springs, on the first rank.
        earlier: States chosen before a restart, on the first rank.
    """

    def __init__(
        self,
        group: Group,
        scene: Scene,
        folder: Path,
        task: Task,
        ratio: float | None,
        earlier: list[GrowthState],
    ) -> None:
        self._task, self._scene, self._folder, self._ratio = task, scene, folder, ratio
        self._wanted = wants_fields(scene, task)
        self._marks = FieldMarks(scene.output.field_steps, scene.loading.extension)
        self._unsaved: list[GrowthState] = []
        self._saved = len(earlier)
        self._series: FieldSeries | None = None
        for length in group.same([state.crack.length for state in earlier]):
            self._marks.due(length)
        self._earlier = earlier
        self._seconds = 0.0

    def open(self) -> None:
        """Start the files with the states of before. First rank only.

        Raises:
            OSError: The files cannot be written.
        """
        if self._wanted:
            started = perf_counter()
            folder, steps = self._folder / "fields", self._scene.output.field_steps
            self._series = FieldSeries(folder, self._task.name, self._scene, steps, self._ratio)
            for state in self._earlier:
                self._series.add(state)
            self._earlier = []
            self._seconds += perf_counter() - started

    def is_due(self, step: Step) -> bool:
        """Return whether the state of this step is to be added; the same on all ranks."""
        return self._wanted and (self._marks.due(step.crack_length) or step.stop is not None)

    def add(self, state: GrowthState | None) -> None:
        """Write a state. First rank only.

        Raises:
            OSError: The files cannot be written.
        """
        if state is not None and self._series is not None:
            started = perf_counter()
            self._series.add(state)
            self._unsaved.append(state)
            self._seconds += perf_counter() - started

    def keep(self, store: Store) -> int:
        """Keep the states chosen since the last call; return how many there are. First rank only.

        Raises:
            OSError: The folder cannot be written.
        """
        for state in self._unsaved:
            store.write_state(self._task, self._saved, state)
            self._saved += 1
        self._unsaved.clear()
        return self._saved

    def close(self) -> None:
        """Finish the files. First rank only.

        Raises:
            OSError: The files cannot be written.
        """
        series, self._series = self._series, None
        if series is not None:
            started = perf_counter()
            series.close()
            self._seconds += perf_counter() - started
            _log.info("%s: fields written in %.3f s", self._task.name, self._seconds)

    def abandon(self) -> None:
        """Remove files that were not finished."""
        series, self._series = self._series, None
        if series is not None:
            series.abandon()
