"""Tables of named columns, in which the public face returns arrays."""

from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from html import escape
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

ROWS_SHOWN = 20


class Table:
    """Read-only columns of equal length, by attribute or by key; iterating gives the rows.

    Args:
        columns: Values of each column, by its name; shape (rows,) each.

    Examples:
        >>> history = Table({"cycles": [0.0, 4200.0], "crack_length_um": [80.0, 81.5]})
        >>> history.crack_length_um
        array([80. , 81.5])
        >>> history["cycles"].tolist()
        [0.0, 4200.0]
        >>> [row["crack_length_um"] for row in history]
        [80.0, 81.5]
        >>> history
        <Table of 2 rows: cycles, crack_length_um>
    """

    __slots__ = ("_arrays",)

    def __init__(self, columns: Mapping[str, ArrayLike]) -> None:
        arrays = {name: np.array(values) for name, values in columns.items()}
        shapes = {name: array.shape for name, array in arrays.items()}
        if len(set(shapes.values())) > 1 or any(len(shape) != 1 for shape in shapes.values()):
            raise ValueError(f"columns of a table must have one axis and one length, got {shapes}")
        for array in arrays.values():
            array.setflags(write=False)
        self._arrays = arrays

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self._arrays)

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return the columns by name, as ``pandas.DataFrame`` takes them."""
        return dict(self._arrays)

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._arrays:
            raise KeyError(self._unknown(name))
        return self._arrays[name]

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name.startswith("_") or name not in self._arrays:
            # Unpickling asks for names before there are any columns.
            raise AttributeError(name if name.startswith("_") else self._unknown(name))
        return self._arrays[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._arrays]

    def __len__(self) -> int:
        return len(next(iter(self._arrays.values()), ()))

    def __iter__(self) -> Iterator[dict[str, Any]]:
        values = [array.tolist() for array in self._arrays.values()]
        return (dict(zip(self._arrays, row, strict=True)) for row in zip(*values, strict=True))

    def __repr__(self) -> str:
        rows = f"{len(self):,} row{'' if len(self) == 1 else 's'}"
        return f"<Table of {rows}: {', '.join(self._arrays)}>"

    def _repr_html_(self) -> str:
        """Return the first rows as a notebook shows them."""
        head = "".join(f"<th>{escape(name)}</th>" for name in self._arrays)
        rows = "".join(
            "<tr>"
            + "".join(f"<td>{escape(_shown(value))}</td>" for value in row.values())
            + "</tr>"
            for row in islice(self, ROWS_SHOWN)
        )
        more = len(self) - ROWS_SHOWN
        end = f"<p>and {more:,} more rows</p>" if more > 0 else ""
        return f"<table><tr>{head}</tr>{rows}</table>{end}"

    def _unknown(self, name: str) -> str:
        close = get_close_matches(str(name), self._arrays, n=1)
        hint = f"did you mean {close[0]}?" if close else f"known are {', '.join(self._arrays)}"
        return f"no column {name}, {hint}"


def _shown(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
