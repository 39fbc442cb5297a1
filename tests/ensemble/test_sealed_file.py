"""Checkpoint files tell whether they are whole."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from pearlite_petsc.ensemble.sealed_file import DamagedFileError, read_sealed, write_sealed

HEADER = {"task": "severe_AT_m0_dk8", "numbers": {"cycles": 0.1 + 0.2, "rate": float("nan")}}
ARRAYS = {
    "damage": np.linspace(0.0, 1.0, 500) ** 3,
    "kept": np.arange(7, dtype=np.int64),
    "none": np.empty((0, 2)),
    "loose": np.array([True, False]),
}


@pytest.fixture
def sealed(tmp_path: Path) -> Path:
    path = tmp_path / "folder" / "a.h5"
    write_sealed(path, HEADER, ARRAYS)
    return path


def test_header_and_arrays_come_back_bit_for_bit(sealed: Path) -> None:
    header, arrays = read_sealed(sealed)
    assert header["task"] == HEADER["task"]
    assert header["numbers"]["cycles"] == 0.1 + 0.2
    assert np.isnan(header["numbers"]["rate"])
    assert arrays.keys() == ARRAYS.keys()
    for name, values in ARRAYS.items():
        assert arrays[name].dtype == values.dtype
        assert np.array_equal(arrays[name], values)


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 0.9, 0.999])
def test_a_truncated_file_is_refused_with_its_name(share: float, sealed: Path) -> None:
    content = sealed.read_bytes()
    sealed.write_bytes(content[: int(share * len(content))])
    with pytest.raises(DamagedFileError, match="a.h5"):
        read_sealed(sealed)


def test_a_changed_number_is_noticed(sealed: Path) -> None:
    with h5py.File(sealed, "r+") as file:
        file["arrays/damage"][123] += 1e-15
    with pytest.raises(DamagedFileError, match="content is not what was written"):
        read_sealed(sealed)


def test_files_of_others_and_of_other_versions_are_refused(sealed: Path, tmp_path: Path) -> None:
    with h5py.File(sealed, "r+") as file:
        file.attrs["format_version"] = 99
    with pytest.raises(DamagedFileError, match="format 99 is not 1"):
        read_sealed(sealed)
    other = tmp_path / "other.h5"
    with h5py.File(other, "w") as file:
        file["arrays/damage"] = [1.0]
    with pytest.raises(DamagedFileError, match="not written by pearlite_petsc"):
        read_sealed(other)
    other.write_bytes(np.random.default_rng(0).bytes(4000))
    with pytest.raises(DamagedFileError, match="other.h5"):
        read_sealed(other)


def test_what_cannot_be_written_leaves_the_older_file(
    sealed: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(number: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OSError, match=r"No space left on device.*a\.h5"):
        write_sealed(sealed, {"task": "another"}, {})
    assert read_sealed(sealed)[0]["task"] == HEADER["task"]
    assert list(sealed.parent.iterdir()) == [sealed]
