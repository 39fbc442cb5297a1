"""Finished tasks that were written before outcomes had an effort and a shape.

Their entries stand side by side: ``solves`` where there is ``effort.solves`` now, ``path`` where
there is ``shape.path``.
"""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from numpy.typing import NDArray

from pearlite_petsc.ensemble.serialize import Arrays
from pearlite_petsc.fatigue.outcome import CrackShape, Effort

_EFFORT = frozenset(field.name for field in fields(Effort))
_SHAPE = frozenset(field.name for field in fields(CrackShape))


def grouped(
    values: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]
) -> tuple[dict[str, Any], Arrays]:
    """Return the values and arrays of an outcome as ``deserialize`` takes them.

    Args:
        values, arrays: Of a finished task, with its entries grouped or side by side.
    """
    if "effort" in values:
        return dict(values), dict(arrays)
    nested = {name: value for name, value in values.items() if name not in _EFFORT}
    nested["effort"] = {name: value for name, value in values.items() if name in _EFFORT}
    if arrays.keys() >= _SHAPE:
        nested["shape"] = {}
    return nested, {
        f"shape.{name}" if name in _SHAPE else name: array for name, array in arrays.items()
    }
