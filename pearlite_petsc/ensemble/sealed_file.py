"""Small HDF5 files that tell whether they are whole: a header (JSON), arrays, and their digest.

The file is made in memory and written by plain calls, so a full disk is an ``OSError`` here and
not a half-closed file inside HDF5.
"""

import hashlib
import io
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from pearlite_petsc.errors import PearliteError

PROGRAM = "pearlite_petsc"
FORMAT_VERSION = 1


class DamagedFileError(PearliteError):
    """A file is truncated, changed, of another program or of another format."""


def write_sealed(path: Path, header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write a file that appears whole and stays through a crash of the machine.

    Args:
        path: The file; its folder is made if need be.
        header: What JSON can hold, NaN included.
        arrays: Arrays by name.

    Raises:
        OSError: It cannot be written; an older file of that name stays as it was.
    """
    text = json.dumps(header, sort_keys=True)
    image = io.BytesIO()
    with h5py.File(image, "w") as file:
        file.attrs["program"] = PROGRAM
        file.attrs["format_version"] = FORMAT_VERSION
        file.attrs["digest"] = _digest(text, arrays)
        file.create_dataset("header", data=text, dtype=h5py.string_dtype())
        for name, values in arrays.items():
            file.create_dataset(f"arrays/{name}", data=values)
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    try:
        with partial.open("wb") as stream:
            stream.write(image.getbuffer())
            stream.flush()
            os.fsync(stream.fileno())
        partial.replace(path)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from None
    finally:
        partial.unlink(missing_ok=True)


def read_sealed(path: Path) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return header and arrays as they were written.

    Raises:
        DamagedFileError: The file is not what ``write_sealed`` wrote, or of another format.
    """
    try:
        with h5py.File(io.BytesIO(path.read_bytes()), "r") as file:
            if file.attrs.get("program") != PROGRAM:
                raise DamagedFileError(f"{path}: was not written by {PROGRAM}")
            version = int(file.attrs["format_version"])
            if version != FORMAT_VERSION:
                raise DamagedFileError(f"{path}: format {version} is not {FORMAT_VERSION}")
            text = str(file["header"].asstr()[()])
            group = file.get("arrays", {})
            arrays = {name: np.asarray(group[name][()]) for name in group}
            if file.attrs["digest"] != _digest(text, arrays):
                raise DamagedFileError(f"{path}: its content is not what was written")
            return json.loads(text), arrays
    except (OSError, KeyError, ValueError, RuntimeError, TypeError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise DamagedFileError(f"{path}: is truncated or no such file ({reason})") from None


def _digest(text: str, arrays: Mapping[str, NDArray[Any]]) -> str:
    digest = hashlib.sha256(text.encode())
    for name in sorted(arrays):
        values = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {values.dtype.str} {values.shape}".encode())
        digest.update(values.tobytes())
    return digest.hexdigest()
