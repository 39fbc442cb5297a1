"""The output folder: who may write into it, what is removed, what a run finds there again."""

import errno
import fcntl
import json
import os
import shutil
import tomllib
from dataclasses import replace
from pathlib import Path
from time import monotonic, sleep
from typing import IO

from pearlite_petsc.config import (
    scene_difference,
    scene_hash,
    scene_to_toml,
)
from pearlite_petsc.ensemble.sealed_file import PROGRAM
from pearlite_petsc.ensemble.store import finished_file
from pearlite_petsc.ensemble.tasks import all_tasks, wants_fields
from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.experiment import KEPT
from pearlite_petsc.output.whole_file import unusable, whole_file
from pearlite_petsc.scene import Output, Scene

MARK = Path("checkpoint") / "run.json"
LOCK = Path("checkpoint") / "lock"
MADE = (
    "scene.resolved.toml",
    "provenance.json",
    "progress.json",
    KEPT,
    "fcg.csv",
    "results.h5",
    "report.html",
    "growth",
    "fields",
    "figures",
    "checkpoint",
)
"""What a run makes in its folder, beside ``run*.log``; nothing else is ever removed."""

FORMAT_VERSION = 1
LOCK_SECONDS = 10.0
"""How long a run that was just killed may take to be gone."""


class OutputFolder:
    """The folder of one run, held by a lock as long as the run lasts. First rank only.

    Args:
        path: The folder.
        scene: What is to be computed.
        resume: Go on with what is there.
        overwrite: Remove what an earlier run made.
        experiment: Text of the measured points, of which the folder keeps a copy.

    Raises:
        SceneError: The folder cannot be used; it is as it was.
    """

    def __init__(
        self,
        path: Path,
        scene: Scene,
        resume: bool,
        overwrite: bool,
        experiment: str | None = None,
    ) -> None:
        self.path = path
        self._lock: IO[str] | None = None
        try:
            find_earlier_run(path, scene, resume, overwrite)
            (path / "checkpoint").mkdir(parents=True, exist_ok=True)
            self._take_lock()
            # Once more: another run may have come and gone since, and this one waited for its lock.
            found = find_earlier_run(path, scene, resume, overwrite)
            if found and not resume:
                self._remove()
            self._enter(scene, experiment)
        except OSError as error:
            self.close()
            raise unusable(path, error) from None
        except SceneError:
            self.close()
            raise
        self.resumed = found and resume

    def close(self) -> None:
        """Give the folder free."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def _take_lock(self) -> None:
        self._lock = (self.path / LOCK).open("a+")
        end = monotonic() + LOCK_SECONDS
        while True:
            try:
                fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                return
            except BlockingIOError:
                if monotonic() > end:
                    self.close()
                    text = f"{self.path}: another run is at work there"
                    raise SceneError(text) from None
                sleep(0.1)
            except OSError:
                # Some network file systems know no locks.
                return

    def _remove(self) -> None:
        for name in MADE:
            if name == "checkpoint":
                continue
            item = self.path / name
            if item.is_dir() and not item.is_symlink():
                shutil.rmtree(item)
            else:
                item.unlink(missing_ok=True)
        for log in self.path.glob("run*.log"):
            log.unlink()
        for name in ("finished", "growing"):
            shutil.rmtree(self.path / "checkpoint" / name, ignore_errors=True)

    def _enter(self, scene: Scene, experiment: str | None) -> None:
        text = scene_to_toml(scene)
        mark = {
            "program": PROGRAM,
            "format_version": FORMAT_VERSION,
            "scene_hash": scene_hash(scene),
            "scene": text,
        }
        with whole_file(self.path / MARK) as partial:
            partial.write_text(json.dumps(mark, indent=1) + "\n", encoding="utf-8")
        with whole_file(self.path / "scene.resolved.toml") as partial:
            partial.write_text(text, encoding="utf-8")
        if experiment is None:
            (self.path / KEPT).unlink(missing_ok=True)
        else:
            with whole_file(self.path / KEPT) as partial:
                partial.write_bytes(experiment.encode())


def find_earlier_run(path: Path, scene: Scene, resume: bool, overwrite: bool) -> bool:
    """Return whether an earlier run of this program is there and may be gone on with or removed.

    Nothing is written, so that it can be asked before MPI is there.

    Args:
        path: The output folder.
        scene, resume, overwrite: As for ``OutputFolder``.

    Raises:
        SceneError: The folder cannot be used.
    """
    if path.exists() and not path.is_dir():
        raise SceneError(f"{path}: is a file; --output needs a folder")
    nearest = next(folder for folder in (path, *path.absolute().parents) if folder.exists())
    if not os.access(nearest, os.W_OK | os.X_OK):
        number = errno.EROFS if os.geteuid() == 0 else errno.EACCES
        raise unusable(path, OSError(number, os.strerror(number)))
    if not path.exists() or _is_abandoned(path):
        return False
    mark = path / MARK
    if not mark.is_file():
        raise SceneError(
            f"{path}: exists and was not made by {PROGRAM}; choose another with --output"
        )
    if not resume and not overwrite:
        raise SceneError(f"{path}: exists; --resume goes on with it, --overwrite replaces it")
    if resume:
        before = output_of_earlier_run(mark, scene)
        refuse_fields_of_the_past(path / "checkpoint", before, scene)
    return True


def _is_abandoned(path: Path) -> bool:
    """Return whether a folder is empty or holds no more than a run that ended at its start left."""
    left = {Path("checkpoint"), LOCK, MARK.with_name(MARK.name + ".partial")}
    return all(item.relative_to(path) in left for item in path.rglob("*"))


def refuse_fields_of_the_past(checkpoint: Path, before: Output, scene: Scene) -> None:
    """Check that no finished crack would need fields that it was not asked for when it grew.

    Raises:
        SceneError: One would.
    """
    old = replace(scene, output=before)
    for task in all_tasks(scene):
        wanted = wants_fields(scene, task)
        had = wants_fields(old, task) and before.field_steps == scene.output.field_steps
        if wanted and not had and finished_file(checkpoint, task).exists():
            raise SceneError(
                f'{checkpoint.parent}: [output] fields = "{scene.output.fields}", field_steps = '
                f"{scene.output.field_steps} ask for fields of {task.name}, which is finished and "
                f'was grown with "{before.fields}", {before.field_steps}; keep these, '
                "or choose another --output"
            )


def output_of_earlier_run(mark: Path, scene: Scene) -> Output:
    """Return what an earlier run of the same scene was asked to write.

    Raises:
        SceneError: It computed another scene, with the keys that differ; or its mark cannot be
            read.
    """
    try:
        content = json.loads(mark.read_text(encoding="utf-8"))
        version, old = content["format_version"], str(content["scene_hash"])
        program, text = content["program"], str(content["scene"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise SceneError(
            f"{mark}: cannot be read ({error}); --overwrite starts from scratch"
        ) from None
    if program != PROGRAM or version != FORMAT_VERSION:
        raise SceneError(f"{mark}: is of {program}, format {version}, not {FORMAT_VERSION}")
    try:
        lines = scene_difference(text, scene_to_toml(scene))
        before = tomllib.loads(text)["output"]
        output = replace(scene.output, fields=before["fields"], field_steps=before["field_steps"])
    except (ValueError, KeyError, TypeError) as error:
        raise SceneError(f"{mark}: holds a scene that cannot be read ({error})") from None
    if old == scene_hash(scene):
        return output
    shown = "; ".join(line for line in lines if not line.startswith("[output]"))
    raise SceneError(
        f"{mark.parent.parent}: holds another scene ({shown or 'its hash differs'}); choose "
        "another --output, or --overwrite"
    )
