"""Outcomes, states and meshes as a header and arrays, and back, bit for bit."""

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pearlite_petsc.fatigue.outcome import Crack, GrowthState, Outcome, StopReason
from pearlite_petsc.tessellation.mesh import Mesh

Arrays = dict[str, NDArray[Any]]


def outcome_to_plain(outcome: Outcome) -> tuple[dict[str, Any], Arrays]:
    """Return the outcome's values and its arrays."""
    values, arrays = _split(outcome)
    values["stop_reason"] = outcome.stop_reason.value
    return values, arrays


def outcome_from_plain(values: Mapping[str, Any], arrays: Arrays) -> Outcome:
    """Return the outcome that ``outcome_to_plain`` took apart."""
    return Outcome(**{**values, **arrays, "stop_reason": StopReason(values["stop_reason"])})


def state_to_plain(state: GrowthState) -> tuple[dict[str, Any], Arrays]:
    """Return the values and arrays of a state, those of its mesh and crack with a prefix."""
    values: dict[str, Any] = {"cycles": state.cycles, "solves": state.solves}
    arrays: Arrays = {}
    for part in ("mesh", "crack"):
        some_values, some_arrays = _split(getattr(state, part))
        values[part] = some_values
        arrays |= {f"{part}.{name}": array for name, array in some_arrays.items()}
    arrays |= _split(state)[1]
    return values, arrays


def state_from_plain(values: Mapping[str, Any], arrays: Arrays) -> GrowthState:
    """Return the state that ``state_to_plain`` took apart."""
    parts: dict[str, Any] = {"cycles": values["cycles"], "solves": values["solves"]}
    builders: dict[str, Callable[..., Mesh | Crack]] = {"mesh": Mesh, "crack": Crack}
    for part, build in builders.items():
        own: dict[str, Any] = {
            name.removeprefix(f"{part}."): array
            for name, array in arrays.items()
            if name.startswith(f"{part}.")
        }
        # JSON knows no tuples.
        own |= {n: tuple(v) if isinstance(v, list) else v for n, v in values[part].items()}
        parts[part] = build(**own)
    parts |= {name: array for name, array in arrays.items() if "." not in name}
    return GrowthState(**parts)


def _split(item: Any) -> tuple[dict[str, Any], Arrays]:
    values: dict[str, Any] = {}
    arrays: Arrays = {}
    for field in fields(item):
        value = getattr(item, field.name)
        if isinstance(value, np.ndarray):
            arrays[field.name] = value
        elif value is not None and not isinstance(value, Mesh | Crack):
            values[field.name] = value
    return values, arrays
