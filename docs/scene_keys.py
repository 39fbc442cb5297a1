"""Prints docs/scene-keys.md from the table that reads the scenes.

./pearlite.sh exec python docs/scene_keys.py > docs/scene-keys.md
"""

import sys
from collections.abc import Iterable

from pearlite_petsc.config.keys import TABLES
from pearlite_petsc.config.states import SOURCE_STATES, STATE_KEYS
from pearlite_petsc.config.values import show
from pearlite_petsc.laws.key import Key
from pearlite_petsc.laws.law import Law

HEAD = """# Scene keys

Made by `docs/scene_keys.py` from the table that the program reads scenes with; a test compares the two.

A scene is a TOML file. Every key may be left out and then takes its default. `name` at the top is
the name of the output folder (default: the file's stem).
"""


def main() -> int:
    """Write the page to standard output."""
    parts = [HEAD]
    for table in TABLES:
        if table.name == "damage":
            parts.append(_states())
        parts.append(_section(table.name, table.help, table.keys))
        parts += [_parameters(law) for law in table.laws if law.parameters]
    sys.stdout.write("\n".join(parts))
    return 0


def _section(name: str, help: str, keys: Iterable[Key]) -> str:
    lines = [f"## [{name}]", ""]
    if help:
        lines += [f"{help[0].upper()}{help[1:]}.", ""]
    return "\n".join([*lines, *_rows(keys)]) + "\n"


def _parameters(law: Law) -> str:
    chosen = f'With `{law.key} = "{law.name}"`, also in `[{law.table}]`:'
    return "\n".join([chosen, "", *_rows(law.parameters)]) + "\n"


def _rows(keys: Iterable[Key]) -> list[str]:
    lines = ["| key | default | allowed | meaning |", "|---|---|---|---|"]
    return lines + [f"| `{k.name}` | {_default(k)} | {_allowed(k)} | {k.help} |" for k in keys]


def _states() -> str:
    names = list(SOURCE_STATES)
    lines = [
        "## [states.NAME]",
        "",
        "One table per state; the source's five states if there is none. A state with one of the names below",
        "may leave keys out; a state with a name of your own needs all four.",
        "",
        "| key | allowed | meaning |",
        "|---|---|---|",
        *(f"| `{k.name}` | {_allowed(k)} | {k.help} |" for k in STATE_KEYS),
        "",
        f"| default | {' | '.join(names)} |",
        "|---|" + "---|" * len(names),
    ]
    for key in STATE_KEYS:
        values = (show(SOURCE_STATES[name][key.name]) for name in names)
        lines.append(f"| `{key.name}` | {' | '.join(values)} |")
    return "\n".join(lines) + "\n"


def _default(key: Key) -> str:
    value = list(key.default) if key.type == "numbers" else key.default
    return f"`{show(value)}`"


def _allowed(key: Key) -> str:
    if key.choices:
        return ", ".join(f"`{show(choice)}`" for choice in key.choices)
    if key.limits is None:
        return {"boolean": "`true`, `false`"}.get(key.type, "text")
    if key.type == "integer":
        return f"whole number from {key.limits.low:.0f} to {key.limits.high:.0f}"
    each = "one or more numbers, each " if key.type == "numbers" else ""
    return f"{each}{key.limits}"


if __name__ == "__main__":
    sys.exit(main())
