"""A user's own measured points: CSV with state, delta_k_mpa_sqrt_m, da_dn_m_per_cycle."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.user_table import Row, UserTable, parse_number, parse_table, read_text

COLUMNS = ("state", "delta_k_mpa_sqrt_m", "da_dn_m_per_cycle")
RUN_OUT = "run_out"
"""Column that may be there: whether no growth was seen, so that da/dN is only an upper bound."""

LARGEST = {"delta_k_mpa_sqrt_m": 1e4, "da_dn_m_per_cycle": 1e-3}
"""Beyond these a number is no measurement of fatigue: a lost column, or another unit."""

KEPT = "experiment.csv"
"""Name of the copy that a result folder keeps."""

_WORDS = {"yes": True, "true": True, "1": True, "no": False, "false": False, "0": False, "": False}


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
    return parse_experiment(read_text(path, "measured points"), str(path), states)


def parse_experiment(text: str, name: str, states: Sequence[str] = ()) -> Experiment:
    r"""Return the measured points of CSV text.

    Fields are separated as the header separates them, by commas, semicolons or tabs. A decimal
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
    table = parse_table(text, name, COLUMNS, COLUMNS[1:], "measured points")
    points = tuple(_point(table, row, states) for row in table.rows)
    return Experiment(points, table.notes, text)


def _point(table: UserTable, row: Row, states: Sequence[str]) -> MeasuredPoint:
    where, fields = table.where(row), row.fields
    state = fields["state"]
    if not state:
        raise SceneError(f"{where}: state is empty")
    if not state.isprintable():
        raise SceneError(f"{where}: state = {state!r} is not printable")
    for known in states:
        if state not in states and _letters(state) == _letters(known):
            raise SceneError(
                f"{where}: state = {state!r} is not in the scene, did you mean {known!r}?"
            )
    delta_k, da_dn = (
        parse_number(fields[column], column, where, LARGEST[column]) for column in COLUMNS[1:]
    )
    word = fields.get(RUN_OUT, "")
    if word.lower() not in _WORDS:
        raise SceneError(f"{where}: {RUN_OUT} = {word!r} must be yes or no")
    return MeasuredPoint(state, delta_k, da_dn, _WORDS[word.lower()])


def _letters(state: str) -> str:
    return "".join(filter(str.isalnum, state)).casefold()
