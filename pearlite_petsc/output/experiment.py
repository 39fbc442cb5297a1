"""A user's own measured points: CSV with state, delta_k_mpa_sqrt_m, da_dn_m_per_cycle."""

import csv
import difflib
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pearlite_petsc.errors import SceneError

COLUMNS = ("state", "delta_k_mpa_sqrt_m", "da_dn_m_per_cycle")
RUN_OUT = "run_out"
"""Column that may be there: whether no growth was seen, so that da/dN is only an upper bound."""

LARGEST = {"delta_k_mpa_sqrt_m": 1e4, "da_dn_m_per_cycle": 1e-3}
"""Beyond these a number is no measurement of fatigue: a lost column, or another unit."""

KEPT = "experiment.csv"
"""Name of the copy that a result folder keeps."""

_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs"}
_WORDS = {"yes": True, "true": True, "1": True, "no": False, "false": False, "0": False, "": False}
_NUMBER = re.compile(r"\+?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_THOUSANDS = re.compile(r"\+?[1-9][0-9]{0,2}(?:,[0-9]{3})+")


@dataclass(frozen=True, slots=True)
class MeasuredPoint:
    """One measured rate.

    Attributes:
        state: Name of the state.
        delta_k: Delta-K [MPa sqrt(m)].
        da_dn: da/dN [m/cycle]; of a run-out its upper bound.
        run_out: Whether no growth was seen.
    """

    state: str
    delta_k: float
    da_dn: float
    run_out: bool = False


@dataclass(frozen=True, slots=True)
class Experiment:
    """Content of a file of measured points.

    Attributes:
        points: The points in the file's order.
        notes: What was not read as it stands there (separators, decimal commas).
        text: The file's text.
    """

    points: tuple[MeasuredPoint, ...]
    notes: tuple[str, ...]
    text: str


def read_experiment(path: Path, states: Sequence[str] = ()) -> Experiment:
    """Return the measured points of a CSV file; columns beyond the known ones are ignored.

    Args:
        path: The file.
        states: Names of the scene's states. A name that differs from one of them in case, spaces
            or punctuation only is refused; any other name is a state of its own.

    Raises:
        SceneError: The file is missing or no text, or ``parse_experiment`` refuses what it holds.
    """
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError(f"{path}: measured points cannot be read ({error})") from None
    return parse_experiment(text, str(path), states)


def parse_experiment(text: str, name: str, states: Sequence[str] = ()) -> Experiment:
    r"""Return the measured points of CSV text.

    Fields are separated as the head line separates them, by commas, semicolons or tabs. A decimal
    comma is read where it can be nothing else. Blank lines are passed over.

    >>> head = "state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle"
    >>> parse_experiment(head + "\nsevere_AT,13.5,1.5e-9\n", "points.csv").points
    (MeasuredPoint(state='severe_AT', delta_k=13.5, da_dn=1.5e-09, run_out=False),)

    Args:
        text: The file's content.
        name: Stands for the file in messages.
        states: As in ``read_experiment``.

    Raises:
        SceneError: A column is missing or there twice, a row has more or fewer fields than the
            head, a value cannot be used, or there is no point; the message names line and column.
    """
    separator = _separator(text)
    rows = _rows(text, name, separator)
    _, head = next(rows, (1, []))
    _check_head(head, name)
    points, commas = [], 0
    for line, fields in rows:
        if len(fields) != len(head):
            raise SceneError(f"{name}: line {line}: {_miscount(fields, head, separator)}")
        row = dict(zip(head, fields, strict=True))
        points.append(_point(row, f"{name}: line {line}", states))
        commas += any("," in row[column] for column in COLUMNS[1:])
    if not points:
        raise SceneError(f"{name}: no measured points below the head line")
    notes = []
    if separator != ",":
        notes.append(f"{name}: read with {_SEPARATORS[separator]} between the fields")
    if commas:
        notes.append(f"{name}: decimal commas in {commas} line(s) read as points (13,5 is 13.5)")
    return Experiment(tuple(points), tuple(notes), text)


def _separator(text: str) -> str:
    """Return what the head line separates its fields with: that which gives most known columns."""
    head = text.lstrip().splitlines()[0] if text.strip() else ""

    def known(separator: str) -> int:
        names = {part.strip().strip('"') for part in head.split(separator)}
        return len(names & set(COLUMNS))

    return max(_SEPARATORS, key=lambda separator: (known(separator), head.count(separator)))


def _rows(text: str, name: str, separator: str) -> Iterator[tuple[int, list[str]]]:
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
        raise SceneError(f"{name}: line {reader.line_num}: is no CSV ({error})") from None


def _check_head(head: Sequence[str], name: str) -> None:
    for column in filter(None, head):
        if head.count(column) > 1:
            raise SceneError(f"{name}: column {column!r} is there {head.count(column)} times")
    for column in COLUMNS:
        if column not in head:
            near = {other.casefold(): other for other in reversed(head) if other}
            close = difflib.get_close_matches(column, near, 1)
            found = ", ".join(filter(None, head)) or "none"
            hint = f", is {near[close[0]]!r} meant?" if close else f"; found {found[:200]}"
            raise SceneError(f"{name}: column {column!r} is missing{hint}")


def _miscount(fields: Sequence[str], head: Sequence[str], separator: str) -> str:
    text = f"has {len(fields)} fields where the head line has {len(head)}"
    if separator == "," and len(fields) > len(head):
        text += "; a decimal comma ends a field here, write 13.5 instead of 13,5"
    return text


def _point(row: Mapping[str, str], where: str, states: Sequence[str]) -> MeasuredPoint:
    state = row["state"]
    if not state:
        raise SceneError(f"{where}: state is empty")
    if not state.isprintable():
        raise SceneError(f"{where}: state = {state!r} is not printable")
    for known in states:
        if state not in states and _letters(state) == _letters(known):
            raise SceneError(
                f"{where}: state = {state!r} is none of the scene, is {known!r} meant?"
            )
    delta_k, da_dn = (_number(row[column], column, where) for column in COLUMNS[1:])
    word = row.get(RUN_OUT, "")
    if word.lower() not in _WORDS:
        raise SceneError(f"{where}: {RUN_OUT} = {word!r} must be yes or no")
    return MeasuredPoint(state, delta_k, da_dn, _WORDS[word.lower()])


def _letters(state: str) -> str:
    return "".join(filter(str.isalnum, state)).casefold()


def _number(text: str, column: str, where: str) -> float:
    if _THOUSANDS.fullmatch(text):
        whole, point = text.replace(",", ""), text.replace(",", ".", 1)
        raise SceneError(
            f"{where}: {column} = {text!r} may be {whole} or {point}, write one of them"
        )
    plain = text.replace(",", ".", 1)
    value = float(plain) if _NUMBER.fullmatch(plain) else 0.0
    if not 0.0 < value < float("inf"):
        raise SceneError(f"{where}: {column} = {text!r} is not a positive number")
    if value > LARGEST[column]:
        raise SceneError(
            f"{where}: {column} = {text!r} is above {LARGEST[column]:g}; the column's name says "
            "its unit"
        )
    return value
