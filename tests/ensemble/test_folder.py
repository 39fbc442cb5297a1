"""The output folder: whose it is, and who may write."""

import errno
import json
from pathlib import Path

import pytest

from pearlite_petsc.config import scene_hash
from pearlite_petsc.ensemble import folder as module
from pearlite_petsc.ensemble.folder import MARK, OutputFolder
from pearlite_petsc.ensemble.store import Store
from pearlite_petsc.ensemble.tasks import all_tasks, wants_fields
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.experiment import KEPT
from pearlite_petsc.scene import Scene
from tests.scenes import default_scene

SCENE = default_scene()


def opened(path: Path, scene: Scene = SCENE, resume: bool = False, overwrite: bool = False) -> bool:
    """Open the folder, give it free again, and return whether something was gone on with."""
    output = OutputFolder(path, scene, resume, overwrite)
    output.close()
    return output.resumed


def test_a_new_folder_or_an_empty_one_is_taken(tmp_path: Path) -> None:
    assert not opened(tmp_path / "a" / "b")
    assert (tmp_path / "a" / "b" / "scene.resolved.toml").is_file()
    (tmp_path / "c").mkdir()
    assert not opened(tmp_path / "c", resume=True)


def test_an_earlier_run_is_neither_replaced_nor_gone_on_with_unasked(tmp_path: Path) -> None:
    opened(tmp_path)
    with pytest.raises(SceneError, match="--resume goes on with it, --overwrite replaces it"):
        opened(tmp_path)
    assert opened(tmp_path, resume=True)


def test_overwriting_removes_what_a_run_made_and_nothing_else(tmp_path: Path) -> None:
    opened(tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    for name in ("fcg.csv", "checkpoint/finished/x.h5", "growth/x.csv", "run.1.log"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("old")
    assert not opened(tmp_path, default_scene(window={"width": 300.0}), overwrite=True)
    assert {path.name for path in tmp_path.iterdir()} == {
        "notes.txt",
        "checkpoint",
        "scene.resolved.toml",
    }
    assert not (tmp_path / "checkpoint" / "finished").exists()
    assert "width_um = 300.0" in (tmp_path / "scene.resolved.toml").read_text()


def test_a_folder_of_something_else_is_never_touched(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    for resume, overwrite in ((False, False), (True, False), (False, True)):
        with pytest.raises(SceneError, match="was not made by pearlite_petsc"):
            opened(tmp_path, SCENE, resume, overwrite)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]
    with pytest.raises(SceneError, match="is a file"):
        opened(tmp_path / "thesis.tex")


def test_going_on_with_another_scene_names_what_differs(tmp_path: Path) -> None:
    opened(tmp_path)
    before = (tmp_path / "scene.resolved.toml").read_text()
    with pytest.raises(SceneError, match=r"\[window\] width_um: 200\.0, now 300\.0"):
        opened(tmp_path, default_scene(window={"width": 300.0}), resume=True)
    assert (tmp_path / "scene.resolved.toml").read_text() == before
    assert opened(tmp_path, default_scene(output={"figures": False}), resume=True)


@pytest.mark.parametrize("content", ["", "{}", "[1]", "\x00", '{"program": "x"}'])
def test_a_damaged_mark_is_refused(content: str, tmp_path: Path) -> None:
    opened(tmp_path)
    (tmp_path / MARK).write_text(content)
    with pytest.raises(SceneError, match=r"run\.json"):
        opened(tmp_path, resume=True)


def test_a_mark_of_another_format_is_refused(tmp_path: Path) -> None:
    opened(tmp_path)
    mark = json.loads((tmp_path / MARK).read_text())
    (tmp_path / MARK).write_text(json.dumps({**mark, "format_version": 7}))
    with pytest.raises(SceneError, match="format 7"):
        opened(tmp_path, resume=True)


def test_two_runs_never_work_in_one_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "LOCK_SECONDS", 0.2)
    first = OutputFolder(tmp_path, SCENE, False, False)
    with pytest.raises(SceneError, match="another run is at work there"):
        opened(tmp_path, resume=True)
    first.close()
    assert opened(tmp_path, resume=True)


@pytest.mark.parametrize("left", ["", "checkpoint/lock", "checkpoint/run.json.partial"])
@pytest.mark.parametrize("resume, overwrite", [(False, False), (True, False), (False, True)])
def test_a_folder_abandoned_at_its_start_is_taken_as_a_new_one(
    left: str, resume: bool, overwrite: bool, tmp_path: Path
) -> None:
    (tmp_path / "checkpoint").mkdir()
    if left:
        (tmp_path / left).touch()
    assert not opened(tmp_path, SCENE, resume, overwrite)
    assert opened(tmp_path, resume=True)


def test_a_disk_that_fills_at_the_start_leaves_a_folder_for_the_next_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*arguments: object, **named: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_text", full)
        with pytest.raises(SceneError, match="cannot be used as output .No space left"):
            opened(tmp_path / "out")
    assert not opened(tmp_path / "out", resume=True)


def test_a_start_that_waited_for_the_lock_looks_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another run comes, writes and goes between the first look and the lock."""
    take = OutputFolder._take_lock

    def late(self: OutputFolder) -> None:
        with monkeypatch.context() as patch:
            patch.setattr(OutputFolder, "_take_lock", take)
            opened(tmp_path, default_scene(microstructure={"seed": 7}))
        take(self)

    before = default_scene(microstructure={"seed": 7})
    monkeypatch.setattr(OutputFolder, "_take_lock", late)
    with pytest.raises(SceneError, match="exists; --resume goes on with it"):
        opened(tmp_path)
    monkeypatch.setattr(OutputFolder, "_take_lock", take)
    assert opened(tmp_path, before, resume=True)


@pytest.mark.parametrize("changes", [{"fields": "all"}, {"field_steps": 7}])
def test_fields_that_a_finished_crack_was_not_asked_for_are_refused(
    changes: dict[str, object], tmp_path: Path
) -> None:
    opened(tmp_path)
    assert opened(tmp_path, default_scene(output={"fields": "none"}), resume=True)
    assert opened(tmp_path, SCENE, resume=True)
    task = next(task for task in all_tasks(SCENE) if wants_fields(default_scene(), task))
    other = next(task for task in all_tasks(SCENE) if not wants_fields(default_scene(), task))
    store = Store(tmp_path / "checkpoint", scene_hash(SCENE))
    for finished in (task, other):
        outcome = Outcome(finished.state.name, 0, finished.delta_k, StopReason.GROWN)
        store.write_finished(finished, outcome, "mesh")
    before = (tmp_path / MARK).read_text()
    with pytest.raises(SceneError, match=r"\[output\] fields = .* which is finished"):
        opened(tmp_path, default_scene(output=changes), resume=True)
    assert (tmp_path / MARK).read_text() == before
    assert opened(tmp_path, default_scene(output={"fields": "none"}), resume=True)
    assert opened(tmp_path, default_scene(output=changes), overwrite=True) is False


def test_the_folder_keeps_a_copy_of_the_measured_points(tmp_path: Path) -> None:
    folder = OutputFolder(tmp_path, SCENE, False, False, "state\nä\n")
    folder.close()
    assert (tmp_path / KEPT).read_text(encoding="utf-8") == "state\nä\n"
    opened(tmp_path, resume=True)
    assert not (tmp_path / KEPT).exists()
