"""From a scene back to TOML, in the file's units; its hash; differences of two scenes."""

import hashlib

from pearlite_petsc.config.keys import STATE_KEYS, TABLES
from pearlite_petsc.config.values import file_text
from pearlite_petsc.scene import Scene

COMMENT_COLUMN = 44
NOT_HASHED = {("output",), ("ensemble", "ranks_per_task")}


def scene_to_toml(scene: Scene) -> str:
    """Return the whole scene as TOML; reading it gives an equal scene, bit for bit."""
    lines = [f'name = "{scene.name}"']
    for table in TABLES:
        if table.name == "damage":
            for state in scene.states:
                lines += ["", f"[states.{state.name}]"]
                lines += [
                    _line(key.name, file_text(key, getattr(state, key.attribute)), key.help)
                    for key in STATE_KEYS
                ]
        part = getattr(scene, table.name)
        lines += ["", _commented(f"[{table.name}]", table.help)]
        lines += [
            _line(key.name, file_text(key, getattr(part, key.attribute)), key.help)
            for key in table.keys
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


def scene_difference(old: Scene, new: Scene) -> tuple[str, ...]:
    """Return one line for each key that differs: "[elements] width_um: 2.0, now 3.0"."""
    before, after = _flat(old), _flat(new)
    return tuple(
        f"[{'.'.join(path[:-1])}] {path[-1]}: {before.get(path, 'none')}, "
        f"now {after.get(path, 'none')}"
        for path in before | after
        if before.get(path) != after.get(path)
    )


def _flat(scene: Scene) -> dict[tuple[str, ...], str]:
    """Return the text of every value by its path, states in the scene's order."""
    values: dict[tuple[str, ...], str] = {
        (table.name, key.name): file_text(key, getattr(getattr(scene, table.name), key.attribute))
        for table in TABLES
        for key in table.keys
    }
    for state in scene.states:
        for key in STATE_KEYS:
            path = ("states", state.name, key.name)
            values[path] = file_text(key, getattr(state, key.attribute))
    return values


def _line(name: str, value: str, help: str) -> str:
    return _commented(f"{name} = {value}", help)


def _commented(text: str, comment: str) -> str:
    return f"{text:<{COMMENT_COLUMN}}  # {comment}" if comment else text
