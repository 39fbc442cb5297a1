import dataclasses
import json
from datetime import UTC, datetime, timedelta
from pathlib import Path

import h5py
import numpy as np
import pytest

from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.provenance import provenance, source_state, write_provenance
from pearlite_petsc.output.results import read_results, write_results
from tests.output import synthetic


def test_outcomes_come_back_bit_for_bit(tmp_path: Path) -> None:
    failed = Outcome("severe_AT", 7, 5e3, StopReason.FAILED, message="element 3: ü < 0\nsecond")
    tasks = [*synthetic.outcomes(meshes=2), failed]
    path = tmp_path / "results.h5"
    write_results(path, "[window]\nwidth_um = 2.0 # µm\n", tasks, {"ranks": 2, "seeds": {"a": 1}})
    back = read_results(path)
    assert back.scene_text == "[window]\nwidth_um = 2.0 # µm\n"
    assert back.provenance == {"ranks": 2, "seeds": {"a": 1}}
    for got, task in zip(back.outcomes, tasks, strict=True):
        for field in dataclasses.fields(Outcome):
            a, b = getattr(got, field.name), getattr(task, field.name)
            if a is None or b is None or isinstance(b, str | dict):
                assert a == b, field.name
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
