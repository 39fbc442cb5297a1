import csv
import dataclasses
import json
import shutil
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from pearlite_petsc.config import load_scene_text
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.provenance import (
    ended_now,
    provenance,
    source_state,
    write_provenance,
)
from pearlite_petsc.output.results import read_results, write_results
from pearlite_petsc.output.snapshot import read_snapshots
from pearlite_petsc.output.tables import (
    FCG_COLUMNS,
    GROWTH_COLUMNS,
    read_fcg,
    read_growth,
    task_name,
    write_fcg,
)
from pearlite_petsc.report import rebuild
from tests.output import synthetic

OLD = Path(__file__).parent / "version_0_1_0"


def test_outcomes_come_back_bit_for_bit(tmp_path: Path) -> None:
    failed = Outcome("severe_AT", 7, 5e3, StopReason.FAILED, message="element 3: ü < 0\nsecond")
    tasks = [*synthetic.outcomes(meshes=2), failed]
    path = tmp_path / "results.h5"
    write_results(path, "[window]\nwidth_um = 2.0 # µm\n", tasks, {"ranks": 2, "seeds": {"a": 1}})
    back = read_results(path)
    assert back.scene_text == "[window]\nwidth_um = 2.0 # µm\n"
    assert back.provenance == {"ranks": 2, "seeds": {"a": 1}}
    for got, task in zip(back.outcomes, tasks, strict=True):
        assert_same(got, task)


def assert_same(got: Any, wanted: Any) -> None:
    """Assert that two dataclasses hold the same, bit for bit but for da/dN."""
    for field in dataclasses.fields(wanted):
        a, b = getattr(got, field.name), getattr(wanted, field.name)
        if a is None or b is None or isinstance(b, str | dict):
            assert a == b, field.name
        elif dataclasses.is_dataclass(b):
            assert_same(a, b)
        elif field.name == "da_dn":
            # In m/cycle on the way.
            np.testing.assert_allclose(a, b, rtol=3e-16)
        else:
            np.testing.assert_array_equal(a, b, err_msg=field.name)
            assert np.asarray(a).dtype == np.asarray(b).dtype, field.name


def test_every_dataset_has_a_unit_and_a_description(tmp_path: Path) -> None:
    path = tmp_path / "results.h5"
    write_results(path, "x = 1", synthetic.outcomes(meshes=1), {})
    seen = []

    def check(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset):
            seen.append(name)
            assert len(item.attrs["unit"]) * len(item.attrs["description"]) > 0, name

    with h5py.File(path) as file:
        file.visititems(check)
    assert len(seen) > 60


def test_names_and_numbers_are_those_of_the_tables(tmp_path: Path) -> None:
    tasks = synthetic.outcomes(meshes=1)
    write_results(tmp_path / "results.h5", "", tasks, {}, "state\na\n")
    write_fcg(tmp_path / "fcg.csv", tasks, list(synthetic.SPEED))
    with h5py.File(tmp_path / "results.h5") as file:
        with (tmp_path / "fcg.csv").open() as stream:
            rows = list(csv.DictReader(stream))
        for name in FCG_COLUMNS:
            column = file["outcomes"][name]
            text = h5py.check_string_dtype(column.dtype) is not None
            values = column.asstr()[()].tolist() if text else column[()].tolist()
            assert [row[name] for row in rows] == [str(value) for value in values], name
        for task in tasks:
            stored = file["tasks"][task_name(task.state, task.mesh_index, task.delta_k)]["history"]
            assert stored.dtype.names == GROWTH_COLUMNS
            assert stored["crack_length_um"].tolist() == task.history[:, 1].tolist()
    assert read_results(tmp_path / "results.h5").experiment_text == "state\na\n"


@pytest.mark.parametrize("value", [1.001, 8.1, 17.77, 4.35, 20.3])
def test_a_delta_k_is_the_very_number_of_the_scene(tmp_path: Path, value: float) -> None:
    scene = load_scene_text(f"[loading]\ndelta_k_mpa_sqrt_m = [{value}]\n", "a.toml")
    task = Outcome("undeformed", 0, scene.loading.delta_k[0], StopReason.ARRESTED)
    write_results(tmp_path / "results.h5", "", [task], {})
    write_fcg(tmp_path / "fcg.csv", [task], [])
    for back in (read_results(tmp_path / "results.h5").outcomes, read_fcg(tmp_path / "fcg.csv")):
        assert back[0].delta_k == scene.loading.delta_k[0]
    with h5py.File(tmp_path / "results.h5") as file:
        assert file["outcomes/delta_k_mpa_sqrt_m"][0] == value


def test_results_of_version_0_1_0_are_read_in_todays_units() -> None:
    old = read_results(OLD / "results.h5")
    assert [o.delta_k for o in old.outcomes] == [4e3, 20.3e3, 4e3, 20.3e3]
    for outcome, row in zip(old.outcomes, read_fcg(OLD / "fcg.csv"), strict=True):
        assert (outcome.state, outcome.mesh_index) == (row.state, row.mesh_index)
        assert (outcome.delta_k, outcome.stop_reason) == (row.delta_k, row.stop_reason)
        np.testing.assert_allclose(outcome.da_dn, row.da_dn, rtol=1e-15)
        name = task_name(row.state, row.mesh_index, row.delta_k)
        np.testing.assert_array_equal(outcome.history, read_growth(OLD / "growth" / f"{name}.csv"))
        assert outcome.shape.path.shape[1] == 2
        assert outcome.tortuosity is None
    assert old.provenance["program"] == "pearlite_petsc 0.1.0"
    scene = load_scene_text(old.scene_text, "a.toml")
    assert scene.loading.delta_k == (4e3, 20.3e3)


def test_a_folder_of_version_0_1_0_gets_a_report(tmp_path: Path) -> None:
    folder = tmp_path / "old"
    shutil.copytree(OLD, folder)
    assert rebuild(folder) == [folder / "report.html"]
    assert (folder / "figures" / "path_undeformed.png").is_file()


def test_fields_of_version_0_1_0_are_read() -> None:
    steps = read_snapshots(OLD / "fields", "undeformed_m0_dk20.3")
    assert [len(step.displacement) == len(step.points) for step in steps] == [True, True]
    history = read_growth(OLD / "growth" / "undeformed_m0_dk20.3.csv")
    assert (steps[-1].cycles, steps[-1].broken.sum()) == (history[-1, 0], history[-1, 3])


def test_no_outcome_at_all_can_be_stored(tmp_path: Path) -> None:
    write_results(tmp_path / "results.h5", "", [], {})
    assert read_results(tmp_path / "results.h5").outcomes == ()


@pytest.mark.parametrize("content", [b"", b"not hdf5", b"\x89HDF\r\n\x1a\n broken"])
def test_a_broken_results_file_is_refused_with_its_name(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "results.h5"
    path.write_bytes(content)
    with pytest.raises(SceneError, match=r"results\.h5"):
        read_results(path)


def test_another_format_version_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "results.h5"
    write_results(path, "", [], {})
    with h5py.File(path, "a") as file:
        file.attrs["format_version"] = 99
    with pytest.raises(SceneError, match="format 99"):
        read_results(path)


def test_provenance_names_versions_times_and_seeds_and_is_json(tmp_path: Path) -> None:
    start = datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC)
    content = provenance(
        ["run", "a.toml"],
        start,
        start + timedelta(seconds=90.5),
        seeds={"microstructure": 1},
        libraries={"PETSc": "3.18.5", "MPI": "Open MPI 4.1.4"},
        ranks=2,
    )
    write_provenance(tmp_path / "provenance.json", content)
    back = json.loads((tmp_path / "provenance.json").read_text())
    assert back == content
    assert back["libraries"]["PETSc"] == "3.18.5"
    assert back["libraries"]["numpy"] == np.__version__
    assert back["wall_s"] == 90.5
    assert back["started"] == "2026-01-02T03:04:05+00:00"
    assert back["seeds"] == {"microstructure": 1}
    assert back["ranks"] == 2


def test_a_folder_without_git_has_no_commit(tmp_path: Path) -> None:
    assert source_state(tmp_path) == {"commit": None, "changed": None}


def test_a_provenance_that_ends_now_keeps_what_was_found_at_the_start() -> None:
    start = datetime.now().astimezone() - timedelta(seconds=90)
    first = provenance(["run"], start, start, {}, {}, 1)
    now = ended_now(first)
    assert 89.0 < now["wall_s"] < 150.0
    assert now["ended"] > first["ended"]
    changed = {"ended", "wall_s"}
    assert {k: v for k, v in now.items() if k not in changed} == {
        k: v for k, v in first.items() if k not in changed
    }
