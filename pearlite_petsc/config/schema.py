"""JSON schema of the scene file, made from the table of keys, for editors and checkers."""

from collections.abc import Iterable
from typing import Any

from pearlite_petsc.config.keys import NAME_PATTERN, tables
from pearlite_petsc.config.read import MOST_STATES
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.config.states import SOURCE_STATES, STATE_KEYS
from pearlite_petsc.config.table import Table, text_key
from pearlite_petsc.config.values import LONGEST_TEXT, MOST_NUMBERS
from pearlite_petsc.laws.catalogue import Laws
from pearlite_petsc.laws.key import Key


def scene_schema(laws: Laws = SHIPPED) -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of a scene that may choose from some laws.

    It holds all that concerns one key; what fits together only in pairs ``load_scene`` checks.
    """
    properties: dict[str, Any] = {
        "name": {
            "type": "string",
            "pattern": f"^{NAME_PATTERN}$",
            "description": "name of the scene and its output folder; the file's stem by default",
        }
    }
    for table in tables(laws):
        properties[table.name] = _table(table.keys, table.help) | _of_laws(table)
        if table.law_key is not None:
            properties[table.name]["properties"] |= _names_of_laws(table, table.law_key)
    known = {name: _state(defaults) for name, defaults in SOURCE_STATES.items()}
    properties["states"] = {
        "type": "object",
        "description": "one table per state; the source's five states if left out",
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


def _names_of_laws(table: Table, chooser: Key) -> dict[str, Any]:
    """Return what may stand beside the keys of a table that chooses a law."""
    pinned = text_key(chooser)
    digits = {"description": pinned.help, "type": "string", "pattern": "^([0-9a-f]{64})?$"}
    return {pinned.name: digits} | {key.name: {} for law in table.laws for key in law.parameters}


def _of_laws(table: Table) -> dict[str, Any]:
    """Return the rules that allow a law's parameters where it is chosen, and only there."""
    chooser = table.law_key
    if chooser is None:
        return {}
    rules: list[dict[str, Any]] = []
    for name in dict.fromkeys(key.name for law in table.laws for key in law.parameters):
        owners = [law for law in table.laws if name in {key.name for key in law.parameters}]
        for law in owners:
            parameter = next(key for key in law.parameters if key.name == name)
            described = _key(parameter) | {"default": parameter.default}
            rules.append(
                _if_chosen(chooser, [law.name], {"then": {"properties": {name: described}}})
            )
        others = {"else": {"properties": {name: False}}}
        rules.append(_if_chosen(chooser, [law.name for law in owners], others))
    return {"allOf": rules} if rules else {}


def _if_chosen(chooser: Key, names: list[str], rule: dict[str, Any]) -> dict[str, Any]:
    """Return a rule for the tables whose law is one of some; left out, it is the default."""
    chosen: dict[str, Any] = {"properties": {chooser.name: {"enum": names}}}
    if chooser.default not in names:
        chosen["required"] = [chooser.name]
    return {"if": chosen, **rule}


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
