"""Finished tasks and checkpoints: kept, found again, refused where they do not belong."""

import math
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pearlite_petsc.config import scene_hash
from pearlite_petsc.ensemble.campaign import look_back
from pearlite_petsc.ensemble.sealed_file import write_sealed
from pearlite_petsc.ensemble.serialize import serialize
from pearlite_petsc.ensemble.status import Status
from pearlite_petsc.ensemble.store import Store, finished_file, mesh_hash
from pearlite_petsc.ensemble.tasks import Task, all_tasks
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.damage_state import notched
from pearlite_petsc.fatigue.outcome import (
    Crack,
    CrackShape,
    Effort,
    GrowthState,
    Outcome,
    StopReason,
)
from pearlite_petsc.growth.checkpoint import FORM, Checkpoint
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.growth.record import new_record
from pearlite_petsc.growth.refinement import Refinement
from pearlite_petsc.solver.equilibrium_state import EquilibriumState
from pearlite_petsc.solver.reuse import ReusePolicy
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.zone import NOWHERE
from tests.scenes import default_scene

SCENE = default_scene(window={"width": 60.0, "height": 60.0, "notch": 20.0})


@pytest.fixture
def task() -> Task:
    return all_tasks(SCENE)[0]


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path, "scene one")


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return prepare_growth(SCENE, SCENE.states[0], 0).mesh


def checkpoint(solves: int) -> Checkpoint:
    record = replace(new_record(80.0), solves=solves, counters={"iterations": 7})
    damage = replace(notched(np.zeros(4, dtype=np.int64)), damage=np.full(4, 0.1 * solves))
    solver = EquilibriumState(damage.damage, np.zeros((2, 3)), ReusePolicy(19.0, excess=math.inf))
    refinement = Refinement(NOWHERE, np.arange(solves))
    return Checkpoint(refinement, damage, solver, None, record)


def assert_same(one: Any, other: Any) -> None:
    """Assert that two dataclasses hold the same, bit for bit."""
    (values, arrays), (others, other_arrays) = serialize(one), serialize(other)
    assert values == others
    assert arrays.keys() == other_arrays.keys()
    for name, array in arrays.items():
        assert array.dtype == other_arrays[name].dtype
        assert array.tobytes() == other_arrays[name].tobytes()


def state(mesh: Mesh, solves: int) -> GrowthState:
    random = np.random.default_rng(solves)
    k, n = mesh.interface_count, mesh.element_count
    crack = Crack(80.5, (80.5, 29.0), np.array([[80.0, 30.0], [80.5, 29.0]]), 1.1, 3)
    values = [random.uniform(size=k) for _ in range(4)]
    return GrowthState(mesh, 3.5, crack, random.uniform(size=(n, 3)), *values, np.zeros(n, bool), 9)


def test_a_finished_task_comes_back_and_its_checkpoints_are_gone(store: Store, task: Task) -> None:
    store.write_checkpoint(task, "mesh", checkpoint(3), 0)
    outcome = Outcome(
        task.state.name, 0, task.delta_k, StopReason.GROWN, da_dn=0.1 + 0.2, tortuosity=None
    )
    store.write_finished(task, outcome, "mesh")
    found = store.read_finished(task)
    assert found is not None
    assert found[1] == "mesh"
    assert_same(found[0], outcome)
    assert store.read_checkpoint(task, "mesh") is None
    store.forget_finished(task)
    assert store.read_finished(task) is None


def test_a_finished_task_with_its_entries_side_by_side_is_read(store: Store, task: Task) -> None:
    values = {"state": task.state.name, "mesh_index": 0, "delta_k": task.delta_k}
    values |= {"stop_reason": "grown", "message": "", "cycles": 7.5, "extension": 2.0}
    values |= {"da_dn": 0.1 + 0.2, "solves": 30, "refinements": 2, "wall_s": 1.5, "elements": 900}
    values |= {"counters": {"iterations": 70.0}}
    arrays = {"history": np.full((3, 7), 0.1), "path": np.ones((4, 2))}
    arrays["broken_pairs"] = np.array([[1, 2], [3, 4]])
    header = {"scene": "scene one", "task": task.name, "mesh": "mesh", "outcome": values}
    write_sealed(finished_file(store.folder, task), header, arrays)
    found = store.read_finished(task)
    assert found is not None
    wanted = Outcome(
        task.state.name,
        0,
        task.delta_k,
        StopReason.GROWN,
        cycles=7.5,
        extension=2.0,
        da_dn=0.1 + 0.2,
        history=arrays["history"],
        effort=Effort(30, 2, {"iterations": 70.0}, 1.5, 900),
        shape=CrackShape(arrays["path"], arrays["broken_pairs"]),
    )
    assert_same(found[0], wanted)


def test_a_failed_task_with_its_entries_side_by_side_has_no_shape(store: Store, task: Task) -> None:
    values = {"state": task.state.name, "mesh_index": 0, "delta_k": task.delta_k}
    values |= {"stop_reason": "failed", "message": "no equilibrium", "wall_s": 1.5}
    header = {"scene": "scene one", "task": task.name, "mesh": "mesh", "outcome": values}
    write_sealed(finished_file(store.folder, task), header, {})
    found = store.read_finished(task)
    assert found is not None
    assert (found[0].message, found[0].effort, found[0].shape) == (
        "no equilibrium",
        Effort(wall_s=1.5),
        None,
    )


def test_two_checkpoints_are_kept_and_the_newest_counts(store: Store, task: Task) -> None:
    for solves in (3, 5, 9):
        store.write_checkpoint(task, "mesh", checkpoint(solves), 0)
        later(store, task)
    found = store.read_checkpoint(task, "mesh")
    assert found is not None
    assert_same(found[0], checkpoint(9))
    newest(store, task).write_bytes(b"HDF")
    found = store.read_checkpoint(task, "mesh")
    assert found is not None
    assert_same(found[0], checkpoint(5))
    assert len(list((store.folder / "growing" / task.name).iterdir())) == 2


def test_states_chosen_for_the_fields_come_back_bit_for_bit(
    store: Store, task: Task, mesh: Mesh
) -> None:
    states = [state(mesh, 1), state(mesh, 2)]
    for number, each in enumerate(states):
        store.write_state(task, number, each)
    store.write_checkpoint(task, "mesh", checkpoint(3), 2)
    found = store.read_checkpoint(task, "mesh")
    assert found is not None
    for back, written in zip(found[1], states, strict=True):
        assert mesh_hash(back.mesh) == mesh_hash(written.mesh)
        assert back.mesh.notch == written.mesh.notch
        assert back.crack.tip == written.crack.tip
        for name in ("displacement", "damage", "normal_stress", "failure_cycles", "loose"):
            assert np.array_equal(getattr(back, name), getattr(written, name))


def test_a_checkpoint_whose_states_are_lost_gives_way_to_the_one_before(
    store: Store, task: Task, mesh: Mesh
) -> None:
    store.write_checkpoint(task, "mesh", checkpoint(3), 0)
    later(store, task)
    store.write_checkpoint(task, "mesh", checkpoint(5), 1)
    found = store.read_checkpoint(task, "mesh")
    assert found is not None
    assert found[0].record.solves == 3


def test_files_of_another_scene_task_or_mesh_are_refused(store: Store, task: Task) -> None:
    store.write_checkpoint(task, "mesh", checkpoint(3), 0)
    with pytest.raises(SceneError, match="made with mesh mesh, this program makes other"):
        store.read_checkpoint(task, "other")
    other = Store(store.folder, "scene two")
    with pytest.raises(SceneError, match="belongs to scene scene one, not scene two"):
        other.check([task])
    store.write_finished(task, Outcome("undeformed", 0, 8e3, StopReason.GROWN), "mesh")
    second = all_tasks(SCENE)[1]
    finished = store.folder / "finished"
    (finished / f"{task.name}.h5").rename(finished / f"{second.name}.h5")
    with pytest.raises(SceneError, match=f"belongs to task {task.name}"):
        store.read_finished(second)


def test_a_checkpoint_of_another_form_is_refused(
    store: Store, task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as older:
        older.setattr("pearlite_petsc.ensemble.store.FORM", 1)
        store.write_checkpoint(task, "mesh", checkpoint(3), 0)
    with pytest.raises(
        SceneError, match=f"has form 1, this version of the program reads form {FORM}"
    ):
        store.read_checkpoint(task, "mesh")


def test_meshes_differ_by_their_hash(mesh: Mesh) -> None:
    again = prepare_growth(SCENE, SCENE.states[0], 0).mesh
    other = prepare_growth(SCENE, SCENE.states[0], 1).mesh
    assert mesh_hash(again) == mesh_hash(mesh)
    assert mesh_hash(other) != mesh_hash(mesh)


def newest(store: Store, task: Task) -> Path:
    files = (store.folder / "growing" / task.name).glob("*.h5")
    return max(files, key=lambda path: path.stat().st_mtime_ns)


def later(store: Store, task: Task) -> None:
    """Make every checkpoint a second older, for file systems with coarse times."""
    for path in (store.folder / "growing" / task.name).glob("*.h5"):
        stamp = path.stat().st_mtime_ns - 10**9
        os.utime(path, ns=(stamp, stamp))


def test_checkpoints_of_a_finished_task_are_dropped_at_the_next_start(
    tmp_path: Path, task: Task
) -> None:
    store = Store(tmp_path / "checkpoint", scene_hash(SCENE))
    outcome = Outcome(task.state.name, 0, task.delta_k, StopReason.GROWN, da_dn=0.1)
    store.write_finished(task, outcome, "mesh")
    # As a run leaves them that is killed before it drops them.
    store.write_checkpoint(task, "mesh", checkpoint(3), 0)
    found = look_back(tmp_path, SCENE, retry_failed=False)
    assert found.status[0] == Status.DONE
    assert found.growing == 0
    assert not list((tmp_path / "checkpoint" / "growing").glob("*"))
