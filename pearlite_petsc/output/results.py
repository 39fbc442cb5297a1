"""``results.h5``: scene, every outcome with its history and path, and provenance, in one file.

Names and units are those of ``fcg.csv`` and ``growth/*.csv``.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import CrackShape, Effort, Outcome, StopReason
from pearlite_petsc.output.safe_stream import hdf5_file
from pearlite_petsc.output.tables import (
    GROWTH_COLUMNS,
    UM_PER_M,
    delta_k_from_mpa_sqrt_m,
    delta_k_in_mpa_sqrt_m,
    task_name,
)
from pearlite_petsc.output.whole_file import whole_file

FORMAT_VERSION = 2
FIRST_FORMAT = 1
"""Of version 0.1.0: datasets have the names and units of the program's attributes."""


@dataclass(frozen=True, slots=True)
class _Column:
    """A dataset with one value per task.

    Attributes:
        attribute: Of ``Outcome``, or of its effort as ``effort.solves``.
        name: Of the dataset.
        unit, description: Its attributes.
        to_file, from_file: Between the program's unit and the file's.
    """

    attribute: str
    name: str
    unit: str
    description: str
    to_file: Callable[[Any], Any] = lambda value: value
    from_file: Callable[[Any], Any] = lambda value: value

    @property
    def first_name(self) -> str:
        """Name of the dataset in files of 0.1.0."""
        return self.attribute.rpartition(".")[2]


_COLUMNS = (
    _Column("state", "state", "1", "name of the sheared state"),
    _Column("mesh_index", "mesh", "1", "number of the mesh (repetition)"),
    _Column(
        "delta_k",
        "delta_k_mpa_sqrt_m",
        "MPa sqrt(m)",
        "range of the stress intensity factor",
        delta_k_in_mpa_sqrt_m,
        delta_k_from_mpa_sqrt_m,
    ),
    _Column(
        "stop_reason",
        "stop_reason",
        "1",
        "why the task ended",
        lambda reason: reason.value,
        StopReason,
    ),
    _Column("message", "message", "1", "error message of a failed task"),
    _Column("cycles", "cycles", "cycle", "load cycles N at the end"),
    _Column("extension", "extension_um", "um", "crack growth along x"),
    _Column(
        "da_dn",
        "da_dn_m_per_cycle",
        "m/cycle",
        "slope of crack length over cycles, NaN where there is no rate",
        lambda rate: rate / UM_PER_M,
        lambda rate: rate * UM_PER_M,
    ),
    _Column(
        "tortuosity",
        "tortuosity",
        "1",
        "path length over x-extent, NaN where the extent is below one colony",
        lambda value: np.nan if value is None else value,
        lambda value: None if np.isnan(value) else value,
    ),
    _Column("effort.solves", "solves", "1", "linear solves"),
    _Column("effort.refinements", "refinements", "1", "meshes replaced on the way"),
    _Column("effort.wall_s", "wall_s", "s", "wall time"),
    _Column("effort.elements", "elements", "1", "elements of the last mesh"),
    _Column(
        "effort.counters",
        "counters",
        "1",
        "JSON: fallbacks and iterations of the solver",
        json.dumps,
        json.loads,
    ),
)
_EFFORT = "effort."
_HISTORY = np.dtype(
    [(name, np.int64 if name == "broken_interfaces" else np.float64) for name in GROWTH_COLUMNS]
)


@dataclass(frozen=True, slots=True, eq=False)
class Results:
    """Content of a ``results.h5``.

    Attributes:
        scene_text: The resolved scene (TOML).
        outcomes: Every task.
        provenance: What ran, where and when.
        experiment_text: The file of measured points that the scene names, None without one.
    """

    scene_text: str
    outcomes: tuple[Outcome, ...]
    provenance: dict[str, Any]
    experiment_text: str | None = None


def write_results(
    path: Path,
    scene_text: str,
    outcomes: Sequence[Outcome],
    provenance: dict[str, Any],
    experiment_text: str | None = None,
) -> None:
    """Write all results; the file appears whole.

    Args:
        path: ``results.h5``.
        scene_text: The resolved scene (TOML).
        outcomes: Every task; arrays that are None are left out.
        provenance: Anything that JSON can hold.
        experiment_text: Text of the measured points (CSV), None for none.

    Raises:
        OSError: The file cannot be written.
    """
    with whole_file(path) as partial, hdf5_file(partial) as file:
        file.attrs["format_version"] = FORMAT_VERSION
        _put(file, "scene", scene_text, "1", "resolved scene (TOML)")
        _put(file, "provenance", json.dumps(provenance), "1", "what ran, where and when (JSON)")
        if experiment_text is not None:
            _put(file, "experiment", experiment_text, "1", "measured points (CSV)")
        table = file.create_group("outcomes")
        for column in _COLUMNS:
            values = [column.to_file(attrgetter(column.attribute)(o)) for o in outcomes]
            text = any(isinstance(value, str) for value in values)
            data = values if text else np.array(values)
            _put(table, column.name, data, column.unit, column.description)
        tasks = file.create_group("tasks")
        for o in outcomes:
            _put_arrays(tasks.create_group(task_name(o.state, o.mesh_index, o.delta_k)), o)


def read_results(path: Path) -> Results:
    """Return what ``write_results`` wrote, da/dN to the last digit but one; files of 0.1.0, too.

    Raises:
        SceneError: The file is missing, is no HDF5 or has another format.
    """
    try:
        with h5py.File(path, "r") as file:
            version = int(file.attrs["format_version"])
            if version not in (FIRST_FORMAT, FORMAT_VERSION):
                raise SceneError(f"{path}: format {version} is not {FORMAT_VERSION}")
            experiment = file.get("experiment")
            return Results(
                scene_text=file["scene"].asstr()[()],
                outcomes=_outcomes(file, first=version == FIRST_FORMAT),
                provenance=json.loads(file["provenance"].asstr()[()]),
                experiment_text=None if experiment is None else experiment.asstr()[()],
            )
    except (OSError, KeyError, ValueError) as error:
        raise SceneError(f"{path}: cannot be read as results ({error})") from None


def _put_arrays(group: Any, outcome: Outcome) -> None:
    if outcome.history is not None:
        rows = np.array([tuple(row) for row in outcome.history.tolist()], dtype=_HISTORY)
        units = "cycle, um, um, 1, 1, 1, 1"
        about = "N, furthest x, length of the path, broken, K_I, K_II over Delta-K, misfit of K"
        _put(group, "history", rows, units, about)
    if outcome.shape is not None:
        about = "vertices of the crack path at the end, x and y"
        _put(group, "path_um", outcome.shape.path, "um", about)
        about = "nuclei of the two elements of each broken interface, notch excluded"
        _put(group, "broken_pairs", outcome.shape.broken_pairs, "1", about)


def _put(group: Any, name: str, data: Any, unit: str, description: str) -> None:
    if isinstance(data, list):
        dataset = group.create_dataset(name, data=data, dtype=h5py.string_dtype(), shape=len(data))
    else:
        dataset = group.create_dataset(name, data=data)
    dataset.attrs["unit"], dataset.attrs["description"] = unit, description


def _outcomes(file: Any, first: bool) -> tuple[Outcome, ...]:
    columns: dict[str, list[Any]] = {}
    for column in _COLUMNS:
        dataset = file["outcomes"][column.first_name if first else column.name]
        text = h5py.check_string_dtype(dataset.dtype) is not None
        columns[column.attribute] = (dataset.asstr()[()] if text else dataset[()]).tolist()
    outcomes = []
    for values in zip(*columns.values(), strict=True):
        row = dict(zip(columns, values, strict=True))
        for column in _COLUMNS:
            same_unit = first and column.attribute in ("delta_k", "da_dn")
            if not same_unit:
                row[column.attribute] = column.from_file(row[column.attribute])
        group = file["tasks"][task_name(row["state"], row["mesh_index"], row["delta_k"])]
        effort = {
            name.removeprefix(_EFFORT): row.pop(name)
            for name in columns
            if name.startswith(_EFFORT)
        }
        outcomes.append(
            Outcome(
                **row,
                history=_side_by_side(group["history"][()], first) if "history" in group else None,
                effort=Effort(**effort),
                shape=_shape(group, first),
            )
        )
    return tuple(outcomes)


def _shape(group: Any, first: bool) -> CrackShape | None:
    path = "path" if first else "path_um"
    return CrackShape(group[path][()], group["broken_pairs"][()]) if path in group else None


def _side_by_side(stored: Any, first: bool) -> FloatArray:
    """Return the columns of a history, NaN where a file has not got one; shape (h, 7)."""
    history = np.full((len(stored), len(GROWTH_COLUMNS)), np.nan)
    if first:
        history[:, : stored.shape[1]] = stored
        return history
    for column, name in enumerate(GROWTH_COLUMNS):
        if name in stored.dtype.names:
            history[:, column] = stored[name]
    return history
