"""``checkpoint/`` of a result: finished tasks, one file each, and cracks on their way.

``finished/<task>.h5`` holds an outcome; ``growing/<task>/a.h5`` and ``b.h5`` the last two
checkpoints of a crack; ``growing/<task>/state_<k>.h5`` states already chosen for its fields.
"""

import hashlib
import logging
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pearlite_petsc.ensemble.flat_outcome import grouped
from pearlite_petsc.ensemble.sealed_file import DamagedFileError, read_sealed, write_sealed
from pearlite_petsc.ensemble.serialize import Arrays, deserialize, serialize
from pearlite_petsc.ensemble.tasks import Task
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import GrowthState, Outcome
from pearlite_petsc.growth.checkpoint import FORM, Checkpoint
from pearlite_petsc.tessellation.mesh import Mesh

_log = logging.getLogger(__name__)

_SLOTS = ("a.h5", "b.h5")


def mesh_hash(mesh: Mesh) -> str:
    """Return the SHA-256 of a mesh's elements and interfaces, as hexadecimal digits."""
    digest = hashlib.sha256()
    for name in ("vertices", "offsets", "vertex_indices", "nucleus", "interface_elements", "kind"):
        digest.update(np.ascontiguousarray(getattr(mesh, name)).tobytes())
    return digest.hexdigest()


def finished_file(folder: Path, task: Task) -> Path:
    """Return the file of a finished task in a ``checkpoint`` folder."""
    return folder / "finished" / f"{task.name}.h5"


def _growing(folder: Path, task: Task) -> Path:
    return folder / "growing" / task.name


class Store:
    """Reads and writes one run's ``checkpoint`` folder; only a group's first rank writes.

    Args:
        folder: The folder.
        scene_hash: ``config.scene_hash`` of the scene; files of another scene are refused.
    """

    def __init__(self, folder: Path, scene_hash: str) -> None:
        self.folder, self._hash = folder, scene_hash

    def write_finished(self, task: Task, outcome: Outcome, mesh: str) -> None:
        """Keep the outcome of a task and drop its checkpoints.

        Raises:
            OSError: The folder cannot be written.
        """
        values, arrays = serialize(outcome)
        self._write(
            finished_file(self.folder, task),
            {"task": task.name, "mesh": mesh, "outcome": values},
            arrays,
        )
        self.forget_growing(task)

    def read_finished(self, task: Task) -> tuple[Outcome, str] | None:
        """Return the outcome of a task and the hash of its mesh; None if it is not finished.

        A damaged file counts as not finished and is named in the log.

        Raises:
            SceneError: The file belongs to another scene or task.
        """
        path = finished_file(self.folder, task)
        if not path.exists():
            return None
        try:
            header, arrays = self._read(path, task)
            outcome = deserialize(Outcome, *grouped(header["outcome"], arrays))
            return outcome, str(header["mesh"])
        except (DamagedFileError, KeyError, TypeError, ValueError) as error:
            _log.warning("%s; the task is computed again", error)
            return None

    def forget_finished(self, task: Task) -> None:
        """Drop the outcome of a task."""
        finished_file(self.folder, task).unlink(missing_ok=True)

    def write_checkpoint(self, task: Task, mesh: str, checkpoint: Checkpoint, states: int) -> None:
        """Keep a checkpoint beside the one before it.

        Args:
            task: The crack.
            mesh: Hash of its first mesh.
            checkpoint: What ``CrackGrowth.checkpoint`` returned.
            states: States chosen for the fields so far.

        Raises:
            OSError: The folder cannot be written.
        """
        values, arrays = serialize(checkpoint)
        header = {
            "form": FORM,
            "task": task.name,
            "mesh": mesh,
            "states": states,
            "solves": checkpoint.record.solves,
            "crack": values,
        }
        folder = _growing(self.folder, task)
        oldest = min(_SLOTS, key=lambda slot: _age(folder / slot))
        self._write(folder / oldest, header, arrays)

    def read_checkpoint(self, task: Task, mesh: str) -> tuple[Checkpoint, list[GrowthState]] | None:
        """Return the newest whole checkpoint and the states chosen before it, None without one.

        A damaged file is passed over and named in the log.

        Raises:
            SceneError: A checkpoint belongs to another scene, task, mesh or version.
        """
        found = list(self._checkpoints(task))
        for path, header, _ in found:
            if header.get("form") != FORM:
                raise SceneError(
                    f"{path}: has form {header.get('form', 'unknown')}, this version of the program "
                    f"reads form {FORM}; without the file the crack starts from its notch"
                )
            if header["mesh"] != mesh:
                raise SceneError(
                    f"{path}: was made with mesh {header['mesh'][:12]}, this program makes "
                    f"{mesh[:12]}; without the file the crack starts from its notch"
                )
        for _, header, arrays in sorted(found, key=lambda item: -item[1]["solves"]):
            try:
                states = self._read_states(task, int(header["states"]))
            except DamagedFileError as error:
                _log.warning("%s; an older checkpoint is used if there is one", error)
                continue
            return deserialize(Checkpoint, header["crack"], arrays), states
        return None

    def write_state(self, task: Task, number: int, state: GrowthState) -> None:
        """Keep a state chosen for the fields.

        Raises:
            OSError: The folder cannot be written.
        """
        self._write((_growing(self.folder, task) / f"state_{number}.h5"), *_with_task(task, state))

    def forget_growing(self, task: Task) -> None:
        """Drop the checkpoints of a task."""
        shutil.rmtree(_growing(self.folder, task), ignore_errors=True)

    def check(self, tasks: Sequence[Task]) -> list[Task]:
        """Return the tasks that have a checkpoint, and remove what a killed run left half written.

        Raises:
            SceneError: A file belongs to another scene or task.
        """
        for partial in self.folder.rglob("*.partial"):
            partial.unlink(missing_ok=True)
        return [task for task in tasks if any(True for _ in self._checkpoints(task))]

    def _checkpoints(self, task: Task) -> Iterator[tuple[Path, dict[str, Any], Arrays]]:
        for slot in _SLOTS:
            path = _growing(self.folder, task) / slot
            if not path.exists():
                continue
            try:
                header, arrays = self._read(path, task)
            except DamagedFileError as error:
                _log.warning("%s; an older checkpoint is used if there is one", error)
                continue
            yield path, header, arrays

    def _read_states(self, task: Task, count: int) -> list[GrowthState]:
        states = []
        for number in range(count):
            header, arrays = self._read(_growing(self.folder, task) / f"state_{number}.h5", task)
            states.append(deserialize(GrowthState, header["state"], arrays))
        return states

    def _read(self, path: Path, task: Task) -> tuple[dict[str, Any], Arrays]:
        header, arrays = read_sealed(path)
        for name, wanted in (("scene", self._hash), ("task", task.name)):
            if header.get(name) != wanted:
                text = f"belongs to {name} {str(header.get(name))[:40]}, not {wanted[:40]}"
                raise SceneError(f"{path}: {text}")
        return header, arrays

    def _write(self, path: Path, header: dict[str, Any], arrays: Arrays) -> None:
        write_sealed(path, {"scene": self._hash, **header}, arrays)


def _with_task(task: Task, state: GrowthState) -> tuple[dict[str, Any], Arrays]:
    values, arrays = serialize(state)
    return {"task": task.name, "state": values}, arrays


def _age(path: Path) -> int:
    """Return when a file was written [ns], 0 for none."""
    return path.stat().st_mtime_ns if path.exists() else 0
