"""JSON schema of the scene file, made from the table of keys, for editors and checkers."""

from collections.abc import Iterable
from typing import Any

from pearlite_petsc.config.keys import NAME_PATTERN, SOURCE_STATES, STATE_KEYS, TABLES, Key
from pearlite_petsc.config.read import MOST_STATES
from pearlite_petsc.config.values import LONGEST_TEXT, MOST_NUMBERS


def scene_schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of a scene as parsed from TOML.

    It holds all that concerns one key; what fits together only in pairs ``load_scene`` checks.
    """
    properties: dict[str, Any] = {
        "name": {
            "type": "string",
            "pattern": f"^{NAME_PATTERN}$",
            "description": "name of the scene and its output folder; the file's stem by default",
        }
    }
    for table in TABLES:
        properties[table.name] = _table(table.keys, table.help)
    known = {name: _state(defaults) for name, defaults in SOURCE_STATES.items()}
    properties["states"] = {
        "type": "object",
        "description": "one table a state; the source's five if left out",
        "minProperties": 1,
        "maxProperties": MOST_STATES,
        "properties": known,
        "propertyNames": {"pattern": f"^{NAME_PATTERN}$"},
        "additionalProperties": _state({}),
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "scene of pearlite_petsc",
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
    }


def _state(defaults: dict[str, Any]) -> dict[str, Any]:
    table = _table(STATE_KEYS, "", defaults)
    table["required"] = [key.name for key in STATE_KEYS if key.name not in defaults]
    return table


def _table(
    keys: Iterable[Key], help: str, defaults: dict[str, Any] | None = None
) -> dict[str, Any]:
    properties = {}
    for key in keys:
        properties[key.name] = _key(key)
        if defaults is None:
            default = list(key.default) if key.type == "numbers" else key.default
            properties[key.name]["default"] = default
        elif key.name in defaults:
            properties[key.name]["default"] = defaults[key.name]
    table: dict[str, Any] = {
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
    }
    return table | ({"description": help} if help else {})


def _key(key: Key) -> dict[str, Any]:
    described = {"description": key.help}
    match key.type:
        case "boolean":
            return described | {"type": "boolean"}
        case "text" if key.choices:
            return described | {"type": "string", "enum": list(key.choices)}
        case "text":
            return described | {"type": "string", "maxLength": LONGEST_TEXT}
        case "numbers":
            many = {"minItems": 1, "maxItems": MOST_NUMBERS, "uniqueItems": True}
            return described | {"type": "array", "items": _number("number", key), **many}
        case "integer" | "number":
            return described | _number(key.type, key)


def _number(json_type: str, key: Key) -> dict[str, Any]:
    if key.limits is None:
        return {"type": json_type}
    low = "exclusiveMinimum" if key.limits.open_low else "minimum"
    high = "exclusiveMaximum" if key.limits.open_high else "maximum"
    return {"type": json_type, low: key.limits.low, high: key.limits.high}
