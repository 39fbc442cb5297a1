"""Text of a scene file and of overrides as nested tables of raw values, not yet validated."""

import re
import tomllib
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pearlite_petsc.config.values import parse_number, plain, show
from pearlite_petsc.errors import SceneError

LARGEST_FILE = 1_000_000
BARE_WORD = re.compile(r"[A-Za-z_./~][^\"'\[\]{}=,#]*")


@dataclass(slots=True)
class Document:
    """Raw tables, the file's name for messages, and the overrides by the key that they set."""

    name: str
    tables: dict[str, Any]
    overrides: dict[tuple[str, ...], str] = field(default_factory=dict)

    def error(self, path: tuple[str, ...], text: str) -> SceneError:
        """Return the error of a key: where it was given, its table, its name and the text."""
        origin = self.name
        if len(path) == 1:
            given = [text for other, text in self.overrides.items() if other[0] == path[0]]
            origin = f"--set {plain(given[0])}" if given else origin
        for length in range(len(path), 1, -1):
            if path[:length] in self.overrides:
                origin = f"--set {plain(self.overrides[path[:length]])}"
                break
        *table, key = (plain(part, 60) for part in path)
        where = f"[{'.'.join(table)}] {key}" if table else f"[{key}]"
        return SceneError(f"{origin}: {where} {text}")


def read_text(path: Path) -> str:
    """Return the text of a scene file.

    Raises:
        SceneError: If there is no such file, or it is no text file of a sane size.
    """
    name = plain(str(path))
    try:
        if path.is_dir():
            raise SceneError(f"{name}: is a folder, a scene is a TOML file")
        if not path.exists():
            raise SceneError(f"{name}: no such file{_nearest_scene(path)}")
        if not path.is_file():
            raise SceneError(f"{name}: is not a regular file")
        if path.stat().st_size > LARGEST_FILE:
            size = f"{path.stat().st_size} bytes, more than {LARGEST_FILE}"
            raise SceneError(f"{name}: is not a scene: {size}")
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError:
        raise SceneError(f"{name}: is not a text file (UTF-8), a scene is TOML") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError(f"{name}: cannot be read: {reason}") from None


def parse_text(text: str, name: str) -> Document:
    """Return the tables of TOML text.

    Raises:
        SceneError: If it is not TOML; the message has the line.
    """
    try:
        return Document(name, tomllib.loads(text, parse_float=parse_number))
    except RecursionError:
        raise SceneError(f"{name}: is not valid TOML: nested too deeply") from None
    except ValueError as error:
        reason = str(error).replace("end of document", f"the end, line {text.count(chr(10)) + 1}")
        reason = plain(" ".join(reason.split()))
        raise SceneError(f"{name}: is not valid TOML: {reason}") from None


def override(document: Document, text: str) -> None:
    """Set one key of the document from ``table.key=value``; the value is TOML or a bare word.

    Raises:
        SceneError: If the text is not of this form.
    """
    where = f"--set {plain(text)}"
    name, equals, value = text.partition("=")
    path = tuple(part.strip() for part in name.split("."))
    if not equals or not all(path) or len(path) != (3 if path[0] == "states" else 2):
        raise SceneError(f"{where}: must have the form table.key=value or states.name.key=value")
    table = document.tables
    for part in path[:-1]:
        inner = table.setdefault(part, {})
        if not isinstance(inner, dict):
            raise SceneError(f"{where}: {part} is not a table")
        table = inner
    table[path[-1]] = _override_value(value.strip(), where)
    document.overrides[path] = text


def suggestion(word: str, known: tuple[str, ...], elsewhere: dict[str, str]) -> str:
    """Return the end of a message on an unknown key: the nearest known one, or all of them.

    Args:
        word: The unknown key.
        known: Keys that may stand there.
        elsewhere: Table of each key of the other tables.
    """
    # First what differs in upper and lower case only, then names that lack their unit.
    close = [name for name in known if name.lower() == word.lower()]
    close += [name for name in known if name.startswith(f"{word}_")]
    close += get_close_matches(word[:100], known, n=1, cutoff=0.6)
    if close:
        return f"did you mean {close[0]}?"
    if word in elsewhere:
        return f"it belongs to [{elsewhere[word]}]"
    return f"known are {', '.join(known)}"


def _override_value(text: str, where: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {text}", parse_float=parse_number)
    except (ValueError, RecursionError):
        if BARE_WORD.fullmatch(text) and text.isprintable():
            return text
        raise SceneError(f"{where}: {show(text)} is not a value") from None
    if set(parsed) != {"value"}:
        raise SceneError(f"{where}: {show(text)} is not one value")
    return parsed["value"]


def _nearest_scene(path: Path) -> str:
    """Return the start of a question for the scene file that was meant, empty if none is near."""
    found: dict[str, Path] = {}
    for folder in (Path("runs"), path.parent):
        if folder.is_dir():
            found |= {scene.stem: scene for scene in sorted(folder.glob("*.toml"))}
    close = get_close_matches(path.name.removesuffix(".toml")[:200], found, n=1, cutoff=0.5)
    return f", did you mean {plain(str(found[close[0]]))}?" if close else ""
