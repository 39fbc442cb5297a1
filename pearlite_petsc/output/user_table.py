"""Tables from users: CSV read strictly, with decimal commas and separators as people write them."""

import csv
import difflib
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pearlite_petsc.errors import SceneError

_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs"}
_NUMBER = re.compile(r"\+?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_THOUSANDS = re.compile(r"\+?[1-9][0-9]{0,2}(?:,[0-9]{3})+")


@dataclass(frozen=True, slots=True)
class Row:
    """One line of a table.

    Attributes:
        line: Its number in the file, from 1.
        fields: Its text by column.
    """

    line: int
    fields: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class UserTable:
    """A table as it was read.

    Attributes:
        name: Stands for the file in messages.
        columns: Head line.
        rows: Every line that is not blank, below the head.
        notes: What was not read as it stands there (separators, decimal commas).
    """

    name: str
    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    notes: tuple[str, ...]

    def where(self, row: Row) -> str:
        """Return the place of a row for a message."""
        return f"{self.name}: line {row.line}"


def read_text(path: Path, what: str) -> str:
    """Return the text of a file.

    Args:
        path: The file.
        what: What it should hold, for the message.

    Raises:
        SceneError: It is missing or no text.
    """
    try:
        return path.read_bytes().decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError(f"{path}: {what} cannot be read ({error})") from None


def parse_table(
    text: str, name: str, columns: Sequence[str], numbers: Sequence[str], what: str
) -> UserTable:
    """Return the rows of CSV text.

    Fields are separated as the header separates them, by commas, semicolons or tabs. Blank lines
    are passed over.

    Args:
        text: The file's content.
        name: Stands for the file in messages.
        columns: Which must be there.
        numbers: Columns whose decimal commas are counted for the notes.
        what: What the rows are, for the message where there is none.

    Raises:
        SceneError: A column is missing or there twice, a row has more or fewer fields than the
            head, or there is no row.
    """
    separator = _separator(text, columns)
    lines = _lines(text, name, separator)
    _, head = next(lines, (1, []))
    _check_head(head, name, columns)
    rows, commas = [], 0
    for line, fields in lines:
        if len(fields) != len(head):
            raise SceneError(f"{name}: line {line}: {_miscount(fields, head, separator)}")
        row = Row(line, dict(zip(head, fields, strict=True)))
        rows.append(row)
        commas += any("," in row.fields.get(column, "") for column in numbers)
    if not rows:
        raise SceneError(f"{name}: no {what} below the header")
    notes = []
    if separator != ",":
        notes.append(f"{name}: read with {_SEPARATORS[separator]} between the fields")
    if commas:
        notes.append(f"{name}: decimal commas in {commas} line(s) read as points (13,5 is 13.5)")
    return UserTable(name, tuple(head), tuple(rows), tuple(notes))


def parse_number(text: str, column: str, where: str, largest: float, zero: bool = False) -> float:
    """Return a positive number, its decimal comma read where it can be nothing else.

    >>> parse_number("13,5", "delta_k_mpa_sqrt_m", "line 2", 1e4)
    13.5

    Args:
        text: The field.
        column: Its column, for messages.
        where: Its place, for messages.
        largest: Beyond this it is a lost column or another unit.
        zero: Whether 0 is allowed.

    Raises:
        SceneError: It is no such number, or its comma may be either.
    """
    if _THOUSANDS.fullmatch(text):
        whole, point = text.replace(",", ""), text.replace(",", ".", 1)
        raise SceneError(
            f"{where}: {column} = {text!r} may be {whole} or {point}, write one of them"
        )
    plain = text.replace(",", ".", 1)
    value = float(plain) if _NUMBER.fullmatch(plain) else -1.0
    if not (value >= 0.0 if zero else value > 0.0) or value == float("inf"):
        raise SceneError(f"{where}: {column} = {text!r} is not a positive number")
    if value > largest:
        raise SceneError(
            f"{where}: {column} = {text!r} is above {largest:g}; the column's name says its unit"
        )
    return value


def _separator(text: str, columns: Sequence[str]) -> str:
    """Return what the header separates its fields with: that which gives most known columns."""
    head = text.lstrip().splitlines()[0] if text.strip() else ""

    def known(separator: str) -> int:
        names = {part.strip().strip('"') for part in head.split(separator)}
        return len(names & set(columns))

    return max(_SEPARATORS, key=lambda separator: (known(separator), head.count(separator)))


def _lines(text: str, name: str, separator: str) -> Iterator[tuple[int, list[str]]]:
    """Yield line number and stripped fields of each line that is not blank."""
    reader = csv.reader(
        io.StringIO(text, newline=""), delimiter=separator, skipinitialspace=True, strict=True
    )
    before = 0
    try:
        for fields in reader:
            line, before = before + 1, reader.line_num
            if any(map(str.strip, fields)):
                if reader.line_num != line:
                    raise SceneError(
                        f"{name}: line {line}: a quoted field runs on to line {reader.line_num}"
                    )
                yield line, [field.strip() for field in fields]
    except csv.Error as error:
        raise SceneError(f"{name}: line {reader.line_num}: is not CSV ({error})") from None


def _check_head(head: Sequence[str], name: str, columns: Sequence[str]) -> None:
    for column in filter(None, head):
        if head.count(column) > 1:
            raise SceneError(f"{name}: column {column!r} appears {head.count(column)} times")
    for column in columns:
        if column not in head:
            near = {other.casefold(): other for other in reversed(head) if other}
            close = difflib.get_close_matches(column, near, 1)
            found = ", ".join(filter(None, head)) or "none"
            hint = f"; rename column {near[close[0]]!r}?" if close else f"; found {found[:200]}"
            raise SceneError(f"{name}: column {column!r} is missing{hint}")


def _miscount(fields: Sequence[str], head: Sequence[str], separator: str) -> str:
    text = f"has {len(fields)} fields where the header has {len(head)}"
    if separator == "," and len(fields) > len(head):
        text += "; a decimal comma ends a field here, write 13.5 instead of 13,5"
    return text
