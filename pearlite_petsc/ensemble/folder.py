"""The output folder: who may write into it, what is removed, what a run finds there again."""

import errno
import fcntl
import json
import os
import shutil
from pathlib import Path
from time import monotonic, sleep
from typing import IO

from pearlite_petsc.config import (
    scene_difference,
    scene_hash,
    scene_to_toml,
)
from pearlite_petsc.ensemble.sealed_file import PROGRAM
from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.whole_file import unusable, whole_file
from pearlite_petsc.scene import Scene

MARK = Path("checkpoint") / "run.json"
MADE = (
    "scene.resolved.toml",
    "provenance.json",
    "progress.json",
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

    Raises:
        SceneError: The folder cannot be used; it is as it was.
    """

    def __init__(self, path: Path, scene: Scene, resume: bool, overwrite: bool) -> None:
        self.path = path
        self._lock: IO[str] | None = None
        try:
            found = find_earlier_run(path, scene, resume, overwrite)
            (path / "checkpoint").mkdir(parents=True, exist_ok=True)
            self._take_lock()
            if found and not resume:
                self._remove()
            self._enter(scene)
        except OSError as error:
            self.close()
            raise unusable(path, error) from None
        self.resumed = found and resume

    def close(self) -> None:
        """Give the folder free."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def _take_lock(self) -> None:
        self._lock = (self.path / "checkpoint" / "lock").open("a+")
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

    def _enter(self, scene: Scene) -> None:
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
    if not path.exists() or not any(path.iterdir()):
        return False
    mark = path / MARK
    if not mark.is_file():
        raise SceneError(
            f"{path}: exists and was not made by {PROGRAM}; choose another with --output"
        )
    if not resume and not overwrite:
        raise SceneError(f"{path}: exists; --resume goes on with it, --overwrite replaces it")
    if resume:
        refuse_other_scene(mark, scene)
    return True


def refuse_other_scene(mark: Path, scene: Scene) -> None:
    """Check that an earlier run computed the same scene.

    Raises:
        SceneError: It did not, with the keys that differ; or its mark cannot be read.
    """
    try:
        content = json.loads(mark.read_text(encoding="utf-8"))
        version, old = content["format_version"], str(content["scene_hash"])
        program, text = content["program"], str(content["scene"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise SceneError(f"{mark}: cannot be read ({error}); --overwrite begins again") from None
    if program != PROGRAM or version != FORMAT_VERSION:
        raise SceneError(f"{mark}: is of {program}, format {version}, not {FORMAT_VERSION}")
    if old == scene_hash(scene):
        return
    try:
        lines = scene_difference(text, scene_to_toml(scene))
    except ValueError as error:
        raise SceneError(f"{mark}: holds a scene that cannot be read ({error})") from None
    shown = "; ".join(line for line in lines if not line.startswith("[output]"))
    raise SceneError(
        f"{mark.parent.parent}: holds another scene ({shown or 'its hash differs'}); choose "
        "another --output, or --overwrite"
    )
