"""Frozen dataclasses as a header for JSON and named arrays, and back, bit for bit.

The only names are those of the fields: an array of a dataclass or mapping inside another is called
``outer.inner``.
"""

import types
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]

T = TypeVar("T")


def serialize(item: Any) -> tuple[dict[str, Any], Arrays]:
    """Return the values and the arrays of a dataclass; what is None is left out."""
    entries = {field.name: getattr(item, field.name) for field in fields(item) if field.init}
    return _serialize(entries)


def deserialize(kind: type[T], values: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> T:
    """Return the dataclass that ``serialize`` took apart.

    Args:
        kind: Its type.
        values, arrays: What ``serialize`` returned.

    Raises:
        TypeError: A field is missing, or there is one too many.
    """
    hints, required = _fields_of(cast(Any, kind))
    given = {*values, *(name.split(".")[0] for name in arrays)}
    if unknown := given - hints.keys():
        raise TypeError(f"{kind.__name__} has no {', '.join(sorted(unknown))}")
    return kind(
        **{name: _field(hints[name], name, values, arrays) for name in sorted(given | required)}
    )


def _serialize(entries: Mapping[str, Any]) -> tuple[dict[str, Any], Arrays]:
    values: dict[str, Any] = {}
    arrays: Arrays = {}
    for name, value in entries.items():
        if isinstance(value, np.ndarray):
            arrays[name] = value
        elif isinstance(value, Mapping) or is_dataclass(value):
            inner = _serialize(value) if isinstance(value, Mapping) else serialize(value)
            values[name] = inner[0]
            arrays |= {f"{name}.{key}": array for key, array in inner[1].items()}
        elif isinstance(value, Enum):
            values[name] = value.value
        elif value is not None:
            values[name] = value
    return values, arrays


def _field(
    hint: Any, name: str, values: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]
) -> Any:
    if name in arrays:
        return arrays[name]
    value = values.get(name)
    if value is None:
        return None
    if isinstance(hint, type) and issubclass(hint, Enum):
        return hint(value)
    if get_origin(hint) is tuple:
        # JSON knows no tuples.
        return tuple(value)
    if isinstance(value, Mapping):
        start = f"{name}."
        inner = {
            key.removeprefix(start): array for key, array in arrays.items() if key.startswith(start)
        }
        is_nested = isinstance(hint, type) and is_dataclass(hint)
        return deserialize(hint, value, inner) if is_nested else {**value, **inner}
    return value


@cache
def _fields_of(kind: Any) -> tuple[dict[str, Any], set[str]]:
    """Return types (None left out) of the fields that a dataclass is made from; which it needs."""
    hints = get_type_hints(kind)
    made_from = [field for field in fields(kind) if field.init]
    required = {
        field.name
        for field in made_from
        if field.default is MISSING and field.default_factory is MISSING
    }
    return {field.name: _without_none(hints[field.name]) for field in made_from}, required


def _without_none(hint: Any) -> Any:
    if get_origin(hint) not in (Union, types.UnionType):
        return hint
    kinds = [kind for kind in get_args(hint) if kind is not type(None)]
    return kinds[0] if len(kinds) == 1 else hint
