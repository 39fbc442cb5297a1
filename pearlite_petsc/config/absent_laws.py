"""Scenes of results whose laws are not at hand: readable, not computable."""

import tomllib
from dataclasses import replace
from typing import Any

from pearlite_petsc.config.keys import TABLES
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.config.table import Table, text_key
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.laws.catalogue import Laws
from pearlite_petsc.laws.cycle_jump import CycleJumpLaw
from pearlite_petsc.laws.damage import DamageLaw
from pearlite_petsc.laws.key import Key, Type
from pearlite_petsc.laws.law import Law, Source
from pearlite_petsc.laws.springs import SpringLaw

_TYPES: tuple[type[Law], ...] = (DamageLaw, SpringLaw, CycleJumpLaw)


def laws_of_results(text: str) -> Laws:
    """Return a catalogue with which the scene of finished results can be read.

    The laws from outside the program that it names stand there with their names, parameters and
    hashes, so that report and tables need no file of theirs; calling one is an error.

    Args:
        text: Scene as ``scene_to_toml`` writes it.
    """
    try:
        tables: dict[str, Any] = tomllib.loads(text)
    except ValueError:
        # Whoever reads the scene says what is wrong with it.
        return SHIPPED
    found = [_absent(table, tables.get(table.name)) for table in TABLES if table.law_key]
    absent = {(law.table, law.name): law for law in found if law is not None}
    kept = [law for law in SHIPPED.laws if (law.table, law.name) not in absent]
    return replace(SHIPPED, laws=(*kept, *absent.values()))


def _absent(table: Table, given: Any) -> Law | None:
    """Return the law that a table names with the hash of its text, None if it names none so."""
    key = table.law_key
    if key is None or not isinstance(given, dict):
        return None
    pinned, name = text_key(key).name, given.get(key.name)
    sha256 = given.get(pinned)
    if not (isinstance(sha256, str) and sha256 and isinstance(name, str)):
        return None
    known = {pinned, *(key.name for key in table.keys)}
    kind = next(kind for kind in _TYPES if (kind.table, kind.key) == (table.name, key.attribute))

    def unavailable(*arguments: Any, **parameters: Any) -> Any:
        raise PearliteError(f'law "{name}" was not loaded: --load the file with SHA-256 {sha256}')

    try:
        return kind(
            name=name,
            help="not loaded",
            function=unavailable,
            parameters=tuple(_key(*item) for item in given.items() if item[0] not in known),
            source=Source("a file that is not loaded", sha256),
        )
    except ValueError:
        return None


def _key(name: str, value: Any) -> Key:
    """Return a key that takes what it has."""
    kind: Type = "text"
    if isinstance(value, bool):
        kind = "boolean"
    elif isinstance(value, int):
        kind = "integer"
    elif isinstance(value, float):
        kind = "number"
    elif isinstance(value, list):
        kind = "numbers"
    return Key(name, name, kind, tuple(value) if isinstance(value, list) else value, "of the law")
