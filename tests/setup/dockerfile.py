"""The Dockerfile as data: its stages, and the files that it copies."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]


@dataclass
class Stage:
    """One stage: the image or stage it starts from and its instructions in order."""

    name: str
    start: str
    instructions: list[tuple[str, str]] = field(default_factory=list)


def stages(text: str) -> dict[str, Stage]:
    """Return the stages of a Dockerfile by name."""
    found: dict[str, Stage] = {}
    lines = re.sub(r"\\\n", " ", re.sub(r"(?m)^\s*#.*\n", "", text)).splitlines()
    stage: Stage | None = None
    for line in filter(str.strip, lines):
        word, rest = line.split(None, 1)
        if word == "FROM":
            start, _, name = rest.split()
            stage = found[name] = Stage(name, start)
        elif stage is not None:
            stage.instructions.append((word, rest))
    return found


def chain(found: dict[str, Stage], name: str) -> list[Stage]:
    """Return the stages that lead to the one named, first the one that starts from an image."""
    stage = found[name]
    return [*(chain(found, stage.start) if stage.start in found else []), stage]


def copied(source: str, ignored: Sequence[str]) -> Iterator[Path]:
    """Yield the files (relative to the project) that COPY takes, without those of .dockerignore."""
    patterns = [pattern.rstrip("/") for pattern in ignored]
    start = PROJECT / source
    for path in sorted(start.rglob("*")) if start.is_dir() else [start]:
        name = path.relative_to(PROJECT)
        parts = [name, *name.parents]
        if path.is_file() and not any(
            fnmatch(str(part), p) or (p.startswith("**/") and fnmatch(part.name, p[3:]))
            for part in parts
            for p in patterns
        ):
            yield name
