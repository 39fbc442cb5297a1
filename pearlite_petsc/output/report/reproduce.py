"""What ran, when and for how long, and the commands that make it again."""

import json
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from shlex import quote
from typing import Any

from pearlite_petsc.output.report.elements import folded, listing, paragraph, table


def when(provenance: Mapping[str, Any]) -> str:
    """Return when the last of the runs in a folder ended and how long all of them took."""
    if "ended" not in provenance:
        return ""
    ended = str(provenance["ended"]).replace("T", " ")
    sessions = provenance.get("sessions") or [provenance]
    seconds = sum(_seconds(session) for session in sessions)
    ranks = " and ".join(dict.fromkeys(str(s.get("ranks", "?")) for s in sessions))
    runs = f" in {len(sessions)} runs" if len(sessions) > 1 else ""
    return f"Ended {ended}; {seconds:.0f} s{runs} on {ranks} rank(s)."


def _seconds(session: Mapping[str, Any]) -> float:
    """Return how long one run in the folder took [s]."""
    if "wall_s" in session:
        return float(session["wall_s"])
    try:
        began, ended = (datetime.fromisoformat(str(session[key])) for key in ("started", "ended"))
    except (KeyError, ValueError):
        return 0.0
    return (ended - began).total_seconds()


_FACTS = {
    "program": "Program",
    "source": "Source",
    "command": "Command",
    "host": "Host",
    "processor": "Processor",
    "system": "System",
    "ranks": "Ranks",
    "seeds": "Seeds",
    "python": "Python",
    "libraries": "Libraries",
    "scene_hash": "Hash of the scene",
}


def _fact(value: Any) -> str:
    if isinstance(value, Mapping):
        if "commit" in value:
            changed = ", with changes since" if value.get("changed") else ""
            return f"commit {value['commit']}{changed}" if value["commit"] else "not in a checkout"
        # How PETSc was configured fills a screen; it is in the whole list.
        named = {
            name: part
            for name, part in value.items()
            if not name.startswith("petsc_") and part is not None
        }
        return ", ".join(f"{name} {part}" for name, part in named.items())
    return " ".join(map(str, value)) if isinstance(value, list) else str(value)


def how_made(folder: Path, scene_text: str, provenance: Mapping[str, Any]) -> str:
    """Return the section with commands, provenance and scene.

    Args:
        folder: The result folder as it was named.
        scene_text: The resolved scene (TOML).
        provenance: What ran, where and when.
    """
    rows = [[title, _fact(provenance[key])] for key, title in _FACTS.items() if key in provenance]
    own = [law for law in provenance.get("laws", []) if "sha256" in law]
    rows += [[f'Law "{law["name"]}"', f"{law['file']}, SHA-256 {law['sha256']}"] for law in own]
    files = dict.fromkeys(law["file"] for law in own if law["file"].endswith(".py"))
    load = "".join(f" --load {quote(file)}" for file in files)
    here, again = quote(str(folder)), quote(f"{folder}-again")
    commands = (
        "# the same run, from the folder in which this one was started\n"
        f"./pearlite.sh run {here}/scene.resolved.toml{load} --output {again}\n"
        "# this page and its figures from the results alone\n"
        f"./pearlite.sh exec python -m pearlite_petsc.report {here}\n"
    )
    source = (
        "Method: Davoodi Jooneghani, Six, Sharifi, Poletti, Trummer, Fatigue Crack Growth "
        "Simulation of R260 Rail Grade Pearlitic Steel Using the Discrete Element Method, Machines "
        "2025, 13(4), 305, doi 10.3390/machines13040305 (preprint: doi "
        "10.20944/preprints202503.0141.v1)."
    )
    return (
        listing(commands)
        + table(["Provenance", ""], rows, numbers_from=2)
        + folded("All of the provenance", listing(json.dumps(provenance, indent=2, default=str)))
        + folded("Resolved scene", listing(scene_text))
        + paragraph(source)
    )
