"""What a run leaves beside its checkpoints: tables, ``results.h5``, provenance."""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from pearlite_petsc.arrays import BoolArray
from pearlite_petsc.config import scene_hash, scene_to_toml
from pearlite_petsc.ensemble.store import Store
from pearlite_petsc.ensemble.tasks import all_tasks
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.output.doubts import doubts
from pearlite_petsc.output.experiment import Experiment
from pearlite_petsc.output.provenance import write_provenance
from pearlite_petsc.output.results import write_results
from pearlite_petsc.output.tables import write_da_dn, write_fcg, write_growth
from pearlite_petsc.scene import Scene

RARELY = 20.0
"""Time between two writings of a file while cracks grow, in times that the first one took."""


class _Turn:
    """When a file is to be written again: where it has changed, and not too often."""

    def __init__(self) -> None:
        self._count, self._due = 0, 0.0

    def has_come(self, count: int, now: bool) -> bool:
        """Return whether it has changed, and its time has come or is not to be waited for."""
        return count > self._count and (now or monotonic() >= self._due)

    @contextmanager
    def taken(self, count: int) -> Iterator[None]:
        """Write it inside; the next turn comes the later the longer that takes."""
        began = monotonic()
        yield
        self._count = count
        self._due = monotonic() + RARELY * (monotonic() - began)


class Products:
    """Tables, ``results.h5`` and ``provenance.json`` of all finished tasks. First rank only.

    They are kept up to date while cracks grow: whatever ends the run, what is finished is there.

    Args:
        folder: The output folder.
        scene: The scene.
        experiment: Measured points to keep with the results, None for none.
        facts: Returns what ran, where and when, as it is now.
    """

    def __init__(
        self,
        folder: Path,
        scene: Scene,
        experiment: Experiment | None,
        facts: Callable[[], dict[str, Any]],
    ) -> None:
        self._folder, self._scene, self._facts = folder, scene, facts
        self._points = None if experiment is None else experiment.text
        self._store = Store(folder / "checkpoint", scene_hash(scene))
        self._tasks = all_tasks(scene)
        self._rows: dict[int, Outcome] = {}
        self._seen = np.zeros(len(self._tasks), dtype=np.bool_)
        self._earlier = _earlier_facts(folder / "provenance.json")
        self._sessions = list(self._earlier.get("sessions", ()))
        self._table, self._whole = _Turn(), _Turn()

    def update(self, finished: BoolArray, now: bool = False) -> None:
        """Write what has finished since, each file where its turn has come.

        Args:
            finished: Which tasks are finished; (tasks,).
            now: Write everything whether its turn has come or not.

        Raises:
            OSError, RuntimeError: A file cannot be written; HDF5 reports a full disk as either.
        """
        if not self._rows and self.are_complete(int(finished.sum())):
            return
        for number in np.flatnonzero(finished & ~self._seen).tolist():
            self._seen[number] = True
            kept = self._store.read_finished(self._tasks[number])
            if kept is not None:
                self._rows[number] = replace(kept[0], history=None, shape=None)
        count = len(self._rows)
        if self._table.has_come(count, now):
            with self._table.taken(count):
                self._write_fcg(list(self._rows.values()))
        if self._whole.has_come(count, now):
            self.write_all()

    def are_complete(self, finished: int) -> bool:
        """Return whether an earlier run left everything as this one would write and draw it.

        Args:
            finished: Number of finished tasks.
        """
        names = ["fcg.csv", "results.h5", "report.html"]
        if not self._sessions or not all((self._folder / name).is_file() for name in names):
            return False
        same = self._sessions[-1].get("finished_tasks") == finished and self._points is None
        return same and self._earlier.get("scene_text_sha256") == self._scene_digest()

    def remark(self, number: int) -> str:
        """Return why a finished task failed or is doubtful in one line, empty if it is neither."""
        outcome = self._rows.get(number)
        if outcome is None:
            return ""
        first = outcome.message.partition("\n")[0]
        return "; ".join([*([first] if first else []), *doubts(outcome, self._scene.elements)])

    def write_all(self, more: Mapping[str, Any] | None = None) -> None:
        """Write everything.

        Args:
            more: Facts that are known at the end only.

        Raises:
            OSError, RuntimeError: As ``update``.
        """
        with self._whole.taken(len(self._rows)):
            self._write_all(more or {})

    def _write_all(self, more: Mapping[str, Any]) -> None:
        outcomes, hashes = [], {}
        for task in self._tasks:
            kept = self._store.read_finished(task)
            if kept is None:
                continue
            outcomes.append(kept[0])
            hashes[f"{task.state.name}_m{task.mesh_index}"] = kept[1]
            if not (self._folder / "growth" / f"{task.name}.csv").exists():
                write_growth(self._folder / "growth", kept[0])
        facts = {**self._facts(), **more}
        shown = ("command", "started", "ended", "ranks")
        session = {name: facts.get(name) for name in shown} | {"finished_tasks": len(outcomes)}
        facts |= {
            "sessions": [*self._sessions, session],
            "scene_hash": scene_hash(self._scene),
            "scene_text_sha256": self._scene_digest(),
            "mesh_hashes": hashes,
        }
        self._write_fcg(outcomes)
        names = [state.name for state in self._scene.states]
        write_da_dn(self._folder / "da_dn.csv", outcomes, names)
        path = self._folder / "results.h5"
        write_results(path, scene_to_toml(self._scene), outcomes, facts, self._points)
        write_provenance(self._folder / "provenance.json", facts)

    def _scene_digest(self) -> str:
        # The scene's hash leaves out what changes no crack, as which figures are wanted.
        return hashlib.sha256(scene_to_toml(self._scene).encode()).hexdigest()

    def _write_fcg(self, outcomes: Sequence[Outcome]) -> None:
        names = [state.name for state in self._scene.states]
        write_fcg(self._folder / "fcg.csv", outcomes, names)


def _earlier_facts(path: Path) -> dict[str, Any]:
    """Return the provenance that a run before left in this folder, empty if none did."""
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        return {}
