"""What is taken apart for a file comes back bit for bit, and what does not fit is refused."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.ensemble.serialize import deserialize, serialize
from pearlite_petsc.fatigue.outcome import CrackShape, Effort, Outcome, StopReason


@dataclass(frozen=True, eq=False)
class Inner:
    known: Mapping[str, FloatArray]
    place: tuple[float, float]
    weight: float


@dataclass(frozen=True, eq=False)
class Outer:
    inner: Inner
    missing: Inner | None
    values: FloatArray | None
    counts: dict[str, int] = field(default_factory=dict)


def through_json(item: Any) -> Any:
    values, arrays = serialize(item)
    return deserialize(type(item), json.loads(json.dumps(values)), arrays)


def test_nested_dataclasses_come_back_with_arrays_mappings_and_tuples() -> None:
    known = {"rate": np.array([0.1, math.nan]), "damage": np.array([1.0 / 3.0])}
    item = Outer(Inner(known, (1.0, 2.5), math.inf), None, np.eye(2), {"undone": 3})
    back = through_json(item)
    assert back.missing is None and back.counts == {"undone": 3}
    assert back.inner.place == (1.0, 2.5) and back.inner.weight == math.inf
    assert back.inner.known.keys() == known.keys()
    assert all(back.inner.known[name].tobytes() == known[name].tobytes() for name in known)
    assert np.array_equal(back.values, np.eye(2))


def test_what_is_none_or_empty_stays_so() -> None:
    item = Outer(Inner({}, (0.0, 0.0), 0.0), Inner({}, (1.0, 1.0), 1.0), None)
    back = through_json(item)
    assert back.values is None and back.counts == {} and back.inner.known == {}
    assert back.missing is not None and back.missing.weight == 1.0


def test_an_outcome_with_all_its_arrays_comes_back() -> None:
    effort = Effort(5, 2, {"a": 1.0}, 0.1 + 0.2, 900)
    shape = CrackShape(np.ones((3, 2)), np.array([[1, 2]]))
    outcome = Outcome(
        "severe_AT", 3, 8e3, StopReason.BOUNDARY, history=np.eye(4), effort=effort, shape=shape
    )
    back = through_json(outcome)
    assert back.stop_reason is StopReason.BOUNDARY
    assert math.isnan(back.da_dn) and back.tortuosity is None and back.effort == effort
    assert np.array_equal(back.history, np.eye(4))
    assert np.array_equal(back.shape.path, shape.path)
    assert np.array_equal(back.shape.broken_pairs, shape.broken_pairs)


def test_a_field_that_the_type_has_not_is_refused() -> None:
    values, arrays = serialize(Inner({}, (0.0, 0.0), 0.0))
    with pytest.raises(TypeError, match="Inner has no colour"):
        deserialize(Inner, {**values, "colour": 1}, arrays)
    with pytest.raises(TypeError, match="Inner has no extra"):
        deserialize(Inner, values, {"extra.values": np.ones(2)})
