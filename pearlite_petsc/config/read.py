"""From a scene file to the validated scene."""

import re
from collections.abc import Iterable, Mapping
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
from pearlite_petsc.config.keys import NAME_PATTERN, tables
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.config.states import SOURCE_STATES, STATE_KEYS
from pearlite_petsc.config.table import Table, text_key
from pearlite_petsc.config.values import plain, program_value, show
from pearlite_petsc.errors import SceneError
from pearlite_petsc.laws.catalogue import Laws
from pearlite_petsc.laws.key import Key
from pearlite_petsc.laws.law import Law
from pearlite_petsc.scene import Scene, State

MOST_STATES = 100

_MONTH = "jan|feb|mar|apr|may|jun|jul|aug|sept?|oct|nov|dec|march|april|june|july"
NOT_A_WORD = re.compile(
    # What pandas, R and spreadsheets make something else of when they read fcg.csv.
    r"na|nan|null|none|true|false|t|f|inf|infinity"
    r"|[0-9]+(?:[ed][+-]?[0-9]+)?|[0-9]+(?:_[0-9]+)+|0x[0-9a-f]+"
    rf"|[0-9]+(?:-[0-9]+){{1,2}}|[0-9]+-(?:{_MONTH})|(?:{_MONTH})-?[0-9]+",
    re.IGNORECASE,
)


def load_scene(
    path: str | PathLike[str], overrides: Iterable[str] = (), laws: Laws = SHIPPED
) -> Scene:
    """Read and validate a scene file.

    Args:
        path: TOML file; missing tables and keys take their defaults. ``output.experiment`` is
            looked for beside it, then in the working directory.
        overrides: "table.key=value" each, set after the file is read.
        laws: The laws that the scene may choose from.

    Raises:
        SceneError: If anything in it cannot be used; one line that names file, table, key, value
            and limit.
    """
    file = Path(path)
    document = parse_text(read_text(file), plain(str(file)))
    _find_experiment(document, file.parent)
    return _scene(document, file.stem, overrides, laws)


def load_scene_text(
    text: str, name: str, overrides: Iterable[str] = (), laws: Laws = SHIPPED
) -> Scene:
    """Validate the text of a scene file; ``name`` stands for the file in messages.

    Raises:
        SceneError: As ``load_scene``.
    """
    return _scene(parse_text(text, plain(name)), Path(name).stem, overrides, laws)


def scene_from_tables(tables: Mapping[str, Any], name: str, laws: Laws = SHIPPED) -> Scene:
    """Validate a scene given as nested tables, in the names and units of the file.

    Args:
        tables: As ``tomllib.load`` returns them; numbers and arrays of numpy count as well.
        name: Stands for the file in messages.
        laws: The laws that the scene may choose from.

    Raises:
        SceneError: As ``load_scene``.
    """
    if not isinstance(tables, Mapping):
        raise SceneError(f"{name}: {show(tables)} is not a mapping of tables")
    return _scene(Document(name, _as_parsed(tables)), name.lower(), (), laws)


def state_named(scene: Scene, name: str) -> State:
    """Return a state of a scene by its name.

    Raises:
        SceneError: There is none of that name; the message has the nearest one or all of them.
    """
    known = {state.name: state for state in scene.states}
    if name not in known:
        hint = suggestion(str(name), tuple(known), {})
        raise SceneError(f"scene {scene.name}: state {plain(str(name))} is unknown, {hint}")
    return known[name]


def _as_parsed(value: Any) -> Any:
    """Return a value as TOML would have given it."""
    if isinstance(value, Mapping):
        return {str(key): _as_parsed(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_as_parsed(item) for item in value]
    if isinstance(value, PathLike):
        return str(value)
    # numpy's scalars and arrays.
    return value.tolist() if hasattr(value, "tolist") else value


def _scene(document: Document, stem: str, overrides: Iterable[str], laws: Laws) -> Scene:
    # Overrides of one state change the default states, they do not replace them.
    document.tables.setdefault("states", {name: {} for name in SOURCE_STATES})
    for text in overrides:
        override(document, text)
    known = tables(laws)
    _refuse_unknown_tables(document, known)
    values: dict[str, Any] = {
        table.name: table.build(**_of_table(document, table, known, laws)) for table in known
    }
    scene = Scene(name=_name(document, stem), states=_states(document, known), **values)
    problem = first_problem(scene)
    if problem is not None:
        raise document.error(problem[:2], problem[2])
    return scene


def _find_experiment(document: Document, folder: Path) -> None:
    """Let ``output.experiment`` of a file mean the one beside the file, if there is one."""
    output = document.tables.get("output")
    if not isinstance(output, dict):
        return
    name = output.get("experiment")
    if isinstance(name, str) and name.isprintable() and name and (folder / name).is_file():
        output["experiment"] = str(folder / name)


def _refuse_unknown_tables(document: Document, known: tuple[Table, ...]) -> None:
    names = ("name", "states", *(table.name for table in known))
    for name in document.tables:
        if name not in names:
            text = f"is unknown, {suggestion(name, names, _homes(known))}"
            raise document.error((name,), text)


def _homes(known: tuple[Table, ...]) -> dict[str, str]:
    """Return the table of every key."""
    return {key.name: table.name for table in known for key in table.keys}


def _of_table(
    document: Document, table: Table, known: tuple[Table, ...], laws: Laws
) -> dict[str, Any]:
    """Return the attributes of one table, with the law that it chooses."""
    path, key = (table.name,), table.law_key
    if key is None:
        return _values(document, path, table.keys, _homes(known))
    raw = _raw(document, path)
    law = _chosen(document, table, key, raw, laws)
    pinned = text_key(key)
    for other in table.laws:
        for name in {key.name for key in other.parameters} & raw.keys():
            if name not in [key.name for key in law.parameters]:
                text = f"is a parameter of {key.name} = {show(other.name)}, not of {show(law.name)}"
                raise document.error((*path, name), text)
    keys = (*table.keys, pinned, *law.parameters)
    _refuse_unknown(document, path, keys, _homes(known))
    values = _program_values(document, path, table.keys)
    given = _program_values(document, path, law.parameters)
    _refuse_other_text(document, path, pinned, raw.get(pinned.name, ""), law)
    return values | {key.attribute: law.with_values(**given)}


def _chosen(document: Document, table: Table, key: Key, raw: dict[str, Any], laws: Laws) -> Law:
    """Return the law that a table chooses by name."""
    try:
        name = program_value(key, raw.get(key.name, key.default))
    except ValueError as error:
        more = "; ".join(["--load FILE.py adds laws of your own", *laws.unusable])
        raise document.error((table.name, key.name), f"{error} ({more})") from None
    return next(law for law in table.laws if law.name == name)


def _refuse_other_text(
    document: Document, path: tuple[str, ...], pinned: Key, wanted: Any, law: Law
) -> None:
    """Check that the law comes from the text that the scene was written with, if it says so."""
    found = law.source.sha256 if law.source else ""
    if wanted not in ("", found):
        origin = (
            f"that of {law.source.file} is {found}" if law.source else "it comes with the program"
        )
        text = f"= {show(wanted, 70)} is not the text of {show(law.name)}: {origin}"
        raise document.error((*path, pinned.name), text)


def _values(
    document: Document,
    path: tuple[str, ...],
    keys: tuple[Key, ...],
    homes: dict[str, str],
    defaults: dict[str, Any] | None = None,
) -> dict[str, Any]:
    """Return the attributes of one table; keys without a default must be given."""
    _refuse_unknown(document, path, keys, homes)
    return _program_values(document, path, keys, defaults)


def _raw(document: Document, path: tuple[str, ...]) -> dict[str, Any]:
    table: Any = document.tables
    for part in path:
        table = table.get(part, {})
        if not isinstance(table, dict):
            raise document.error(path, f"= {show(table)} must be a table")
    found: dict[str, Any] = table
    return found


def _refuse_unknown(
    document: Document, path: tuple[str, ...], keys: tuple[Key, ...], homes: dict[str, str]
) -> None:
    known = tuple(key.name for key in keys)
    for name in _raw(document, path):
        if name not in known:
            hint = suggestion(name, known, homes)
            raise document.error((*path, name), f"is unknown, {hint}")


def _program_values(
    document: Document,
    path: tuple[str, ...],
    keys: tuple[Key, ...],
    defaults: dict[str, Any] | None = None,
) -> dict[str, Any]:
    table = _raw(document, path)
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


def _states(document: Document, known: tuple[Table, ...]) -> tuple[State, ...]:
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
        if NOT_A_WORD.fullmatch(name):
            text = "is no name for a state: table readers take it for a number, a date or no value"
            raise document.error(path, text)
        if name.lower() in states:
            raise document.error(path, "differs from another state by upper and lower case only")
        values = _values(document, path, STATE_KEYS, _homes(known), SOURCE_STATES.get(name, {}))
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
