"""``results.h5``: scene, every outcome with its history and path, and provenance, in one file."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.safe_stream import hdf5_file
from pearlite_petsc.output.tables import task_name
from pearlite_petsc.output.whole_file import whole_file

FORMAT_VERSION = 1

_COLUMNS: dict[str, tuple[str, str]] = {
    "state": ("1", "name of the sheared state"),
    "mesh_index": ("1", "number of the mesh (repetition)"),
    "delta_k": ("MPa sqrt(um)", "range of the stress intensity factor"),
    "stop_reason": ("1", "why the task ended"),
    "message": ("1", "error message of a failed task"),
    "cycles": ("cycle", "load cycles N at the end"),
    "extension": ("um", "crack growth along x"),
    "da_dn": ("um/cycle", "slope of crack length over cycles, NaN where nothing grew"),
    "tortuosity": ("1", "path length over x-extent, NaN where the extent is below one colony"),
    "solves": ("1", "linear solves"),
    "refinements": ("1", "meshes replaced on the way"),
    "wall_s": ("s", "wall time"),
    "elements": ("1", "elements of the last mesh"),
    "counters": ("1", "JSON: fallbacks and iterations of the solver"),
}
_ARRAYS: dict[str, tuple[str, str]] = {
    "history": (
        "cycle, um, um, 1",
        "columns: cycles, crack length, path length, broken interfaces",
    ),
    "path": ("um", "vertices of the crack path at the end, x and y"),
    "broken_pairs": ("1", "nuclei of the two elements of each broken interface, notch excluded"),
}


@dataclass(frozen=True, slots=True, eq=False)
class Results:
    """Content of a ``results.h5``.

    Attributes:
        scene_text: The resolved scene (TOML).
        outcomes: Every task.
        provenance: What ran, where and when.
    """

    scene_text: str
    outcomes: tuple[Outcome, ...]
    provenance: dict[str, Any]


def write_results(
    path: Path, scene_text: str, outcomes: Sequence[Outcome], provenance: dict[str, Any]
) -> None:
    """Write all results; the file appears whole.

    Args:
        path: ``results.h5``.
        scene_text: The resolved scene (TOML).
        outcomes: Every task; arrays that are None are left out.
        provenance: Anything that JSON can hold.
    """
    with whole_file(path) as partial, hdf5_file(partial) as file:
        file.attrs["format_version"] = FORMAT_VERSION
        _put(file, "scene", scene_text, "1", "resolved scene (TOML)")
        _put(file, "provenance", json.dumps(provenance), "1", "what ran, where and when (JSON)")
        table = file.create_group("outcomes")
        for name, (unit, description) in _COLUMNS.items():
            _put(table, name, _column(name, outcomes), unit, description)
        tasks = file.create_group("tasks")
        for o in outcomes:
            group = tasks.create_group(task_name(o.state, o.mesh_index, o.delta_k))
            for name, (unit, description) in _ARRAYS.items():
                array = getattr(o, name)
                if array is not None:
                    _put(group, name, array, unit, description)


def read_results(path: Path) -> Results:
    """Return what ``write_results`` wrote, bit for bit.

    Raises:
        SceneError: The file is missing, is no HDF5 or has another format.
    """
    try:
        with h5py.File(path, "r") as file:
            version = int(file.attrs["format_version"])
            if version != FORMAT_VERSION:
                raise SceneError(f"{path}: format {version} is not {FORMAT_VERSION}")
            return Results(
                scene_text=file["scene"].asstr()[()],
                outcomes=_outcomes(file),
                provenance=json.loads(file["provenance"].asstr()[()]),
            )
    except (OSError, KeyError, ValueError) as error:
        raise SceneError(f"{path}: cannot be read as results ({error})") from None


def _column(name: str, outcomes: Sequence[Outcome]) -> Any:
    if name == "counters":
        return [json.dumps(o.counters) for o in outcomes]
    if name == "stop_reason":
        return [o.stop_reason.value for o in outcomes]
    if name == "tortuosity":
        return np.array([np.nan if o.tortuosity is None else o.tortuosity for o in outcomes])
    values = [getattr(o, name) for o in outcomes]
    return values if name in ("state", "message") else np.array(values)


def _put(group: Any, name: str, data: Any, unit: str, description: str) -> None:
    if isinstance(data, list):
        dataset = group.create_dataset(name, data=data, dtype=h5py.string_dtype(), shape=len(data))
    else:
        dataset = group.create_dataset(name, data=data)
    dataset.attrs["unit"], dataset.attrs["description"] = unit, description


def _outcomes(file: Any) -> tuple[Outcome, ...]:
    columns: dict[str, list[Any]] = {}
    for name in _COLUMNS:
        dataset = file["outcomes"][name]
        text = h5py.check_string_dtype(dataset.dtype) is not None
        columns[name] = (dataset.asstr()[()] if text else dataset[()]).tolist()
    outcomes = []
    for values in zip(*columns.values(), strict=True):
        row = dict(zip(columns, values, strict=True))
        row["stop_reason"] = StopReason(row["stop_reason"])
        row["counters"] = json.loads(row["counters"])
        if np.isnan(row["tortuosity"]):
            row["tortuosity"] = None
        group = file["tasks"][task_name(row["state"], row["mesh_index"], row["delta_k"])]
        arrays = {name: group[name][()] for name in _ARRAYS if name in group}
        outcomes.append(Outcome(**row, **arrays))
    return tuple(outcomes)
