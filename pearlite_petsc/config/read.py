"""From a scene file to the validated scene."""

import re
from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import Any

from pearlite_petsc.config.checks import first_problem
from pearlite_petsc.config.document import (
    Document,
    override,
    parse_text,
    read_text,
    suggestion,
)
from pearlite_petsc.config.keys import NAME_PATTERN, SOURCE_STATES, STATE_KEYS, TABLES, Key
from pearlite_petsc.config.values import plain, program_value, show
from pearlite_petsc.errors import SceneError
from pearlite_petsc.scene import Scene, State

MOST_STATES = 100


def load_scene(path: str | PathLike[str], overrides: Iterable[str] = ()) -> Scene:
    """Read and validate a scene file.

    Args:
        path: TOML file; missing tables and keys take their defaults.
        overrides: "table.key=value" each, set after the file is read.

    Raises:
        SceneError: If anything in it cannot be used; one line that names file, table, key, value
            and limit.
    """
    file = Path(path)
    return _scene(parse_text(read_text(file), plain(str(file))), file.stem, overrides)


def load_scene_text(text: str, name: str, overrides: Iterable[str] = ()) -> Scene:
    """Validate the text of a scene file; ``name`` stands for the file in messages.

    Raises:
        SceneError: As ``load_scene``.
    """
    return _scene(parse_text(text, plain(name)), Path(name).stem, overrides)


def _scene(document: Document, stem: str, overrides: Iterable[str]) -> Scene:
    # Overrides of one state change the default states, they do not replace them.
    document.tables.setdefault("states", {name: {} for name in SOURCE_STATES})
    for text in overrides:
        override(document, text)
    _refuse_unknown_tables(document)
    values: dict[str, Any] = {
        table.name: table.build(**_values(document, (table.name,), table.keys)) for table in TABLES
    }
    scene = Scene(name=_name(document, stem), states=_states(document), **values)
    problem = first_problem(scene)
    if problem is not None:
        raise document.error(problem[:2], problem[2])
    return scene


def _refuse_unknown_tables(document: Document) -> None:
    known = ("name", "states", *(table.name for table in TABLES))
    elsewhere = {key.name: table.name for table in TABLES for key in table.keys}
    for name in document.tables:
        if name not in known:
            text = f"is unknown, {suggestion(name, known, elsewhere)}"
            raise document.error((name,), text)


def _values(
    document: Document,
    path: tuple[str, ...],
    keys: tuple[Key, ...],
    defaults: dict[str, Any] | None = None,
) -> dict[str, Any]:
    """Return the attributes of one table; keys without a default must be given."""
    table: Any = document.tables
    for part in path:
        table = table.get(part, {})
        if not isinstance(table, dict):
            raise document.error(path, f"= {show(table)} must be a table")
    known = tuple(key.name for key in keys)
    elsewhere = {key.name: other.name for other in TABLES for key in other.keys}
    for name in table:
        if name not in known:
            hint = suggestion(name, known, elsewhere)
            raise document.error((*path, name), f"is unknown, {hint}")
    if defaults is None:
        defaults = {key.name: key.default for key in keys}
    values = {}
    for key in keys:
        if key.name not in table and key.name not in defaults:
            raise document.error((*path, key.name), f"is missing: {key.help}")
        try:
            values[key.attribute] = program_value(key, table.get(key.name, defaults.get(key.name)))
        except ValueError as error:
            raise document.error((*path, key.name), str(error)) from None
    return values


def _states(document: Document) -> tuple[State, ...]:
    tables = document.tables["states"]
    if not isinstance(tables, dict):
        raise document.error(("states",), f"= {show(tables)} must be a table of states")
    if not tables:
        raise document.error(("states",), "is empty, at least one state is needed")
    if len(tables) > MOST_STATES:
        text = f"has {len(tables)} states, at most {MOST_STATES} are allowed"
        raise document.error(("states",), text)
    states: dict[str, State] = {}
    for name in tables:
        path = ("states", name)
        if re.fullmatch(NAME_PATTERN, name) is None:
            text = "is no name for a state: letters, digits, _, + and - only, at most 60"
            raise document.error(path, text)
        if name.lower() in states:
            raise document.error(path, "differs from another state by upper and lower case only")
        values = _values(document, path, STATE_KEYS, SOURCE_STATES.get(name, {}))
        states[name.lower()] = State(name=name, **values)
    return tuple(states.values())


def _name(document: Document, stem: str) -> str:
    """Return the scene's name, usable as a folder's: the key ``name``, else the file's stem."""
    name = document.tables.get("name")
    if name is None:
        return re.sub(r"[^A-Za-z0-9_+-]", "_", stem).lstrip("_+-")[:60] or "scene"
    if not isinstance(name, str) or re.fullmatch(NAME_PATTERN, name) is None:
        text = f"{document.name}: name = {show(name)} must be letters, digits, _, + and - only"
        raise SceneError(f"{text}, at most 60")
    return name
