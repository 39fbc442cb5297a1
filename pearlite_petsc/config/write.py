"""From a scene back to TOML, in the file's units; its hash; differences of two scenes."""

import hashlib
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from pearlite_petsc.config.keys import TABLES
from pearlite_petsc.config.states import STATE_KEYS
from pearlite_petsc.config.table import Table, text_key
from pearlite_petsc.config.values import file_text
from pearlite_petsc.laws.key import Key
from pearlite_petsc.laws.law import Law
from pearlite_petsc.scene import Scene

COMMENT_COLUMN = 44
NOT_HASHED = {("output",), ("ensemble", "ranks_per_task")}


def scene_to_toml(scene: Scene) -> str:
    """Return the whole scene as TOML; reading it gives an equal scene, bit for bit.

    A law from outside the program stands there with its name, parameters and the hash of its text,
    so that reading the scene needs that very text.
    """
    lines = [f'name = "{scene.name}"']
    for table in TABLES:
        if table.name == "damage":
            for state in scene.states:
                lines += ["", f"[states.{state.name}]"]
                lines += [
                    _line(key.name, file_text(key, getattr(state, key.attribute)), key.help)
                    for key in STATE_KEYS
                ]
        lines += ["", _commented(f"[{table.name}]", table.help)]
        lines += [
            _line(key.name, file_text(key, value), key.help)
            for key, value in _entries(table, getattr(scene, table.name))
        ]
    return "\n".join(lines) + "\n"


def scene_hash(scene: Scene) -> str:
    """Return the SHA-256 of all that fixes the results, as hexadecimal digits.

    The name, [output] and the ranks of a task are left out: they change no result beyond rounding.
    """
    values = _flat(scene)
    kept = sorted(
        f"{'.'.join(path)}={value}"
        for path, value in values.items()
        if path not in NOT_HASHED and path[:1] not in NOT_HASHED
    )
    return hashlib.sha256("\n".join(kept).encode()).hexdigest()


def scene_difference(old: str, new: str) -> tuple[str, ...]:
    """Return one line for each key that differs: "[elements] width_um: 2.0, now 3.0".

    Args:
        old, new: Scenes as ``scene_to_toml`` writes them; laws that they name need not be there.

    Raises:
        ValueError: One of them is no TOML.
    """
    before, after = (dict(_leaves(tomllib.loads(text, parse_float=str))) for text in (old, new))
    return tuple(
        f"[{'.'.join(path[:-1])}] {path[-1]}: {before.get(path, 'none')}, "
        f"now {after.get(path, 'none')}"
        for path in before | after
        if len(path) > 1 and before.get(path) != after.get(path)
    )


def laws_of_scene(scene: Scene) -> list[dict[str, Any]]:
    """Return the scene's laws as JSON can hold them, parameters in the file's names and units.

    ``file`` and ``sha256`` say where a law from outside the program comes from.
    """
    found = []
    for law in (scene.damage.law, scene.material.springs, scene.cycle_jump.method):
        keywords = law.keywords()
        texts = [
            f"{key.name} = {file_text(key, keywords[key.attribute])}" for key in law.parameters
        ]
        entry: dict[str, Any] = {"table": law.table, "key": law.key, "name": law.name}
        entry["parameters"] = tomllib.loads("\n".join(texts))
        if law.source is not None:
            entry |= {"file": law.source.file, "sha256": law.source.sha256}
        found.append(entry)
    return found


def _entries(table: Table, part: Any) -> Iterator[tuple[Key, Any]]:
    """Yield every key of a table with its value, also those of the law that it chose."""
    law: Law | None = None
    for key in table.keys:
        value = getattr(part, key.attribute)
        if not isinstance(value, Law):
            yield key, value
            continue
        law = value
        yield key if law.source is None else replace(key, help=law.help), law.name
        if law.source:
            yield text_key(key, law.source), law.source.sha256
    if law is not None:
        keywords = law.keywords()
        yield from ((key, keywords[key.attribute]) for key in law.parameters)


def _flat(scene: Scene) -> dict[tuple[str, ...], str]:
    """Return the text of every value by its path, states in the scene's order."""
    values: dict[tuple[str, ...], str] = {
        (table.name, key.name): file_text(key, value)
        for table in TABLES
        for key, value in _entries(table, getattr(scene, table.name))
    }
    for state in scene.states:
        for key in STATE_KEYS:
            path = ("states", state.name, key.name)
            values[path] = file_text(key, getattr(state, key.attribute))
    return values


def _leaves(tree: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], str]]:
    if isinstance(tree, dict):
        for name, inner in tree.items():
            yield from _leaves(inner, (*path, name))
    elif isinstance(tree, list):
        yield path, f"[{', '.join(map(str, tree))}]"
    else:
        yield path, str(tree).lower() if isinstance(tree, bool) else str(tree)


def _line(name: str, value: str, help: str) -> str:
    return _commented(f"{name} = {value}", help)


def _commented(text: str, comment: str) -> str:
    return f"{text:<{COMMENT_COLUMN}}  # {comment}" if comment else text
