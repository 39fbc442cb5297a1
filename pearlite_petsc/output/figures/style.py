"""One look for all figures: colours that colour-blind readers tell apart, fonts, PNG and SVG."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from pearlite_petsc.output.whole_file import whole_file

DPI = 200
WIDTH = 7.2
"""Width of a figure over the whole text [inch]."""

MOST_NAMED = 12
"""Delta-K up to which each has its own entry in a legend."""

INK = "#1a1a1a"
GREY = "#8c8c8c"
PALE = "#dddddd"
BROKEN = "#b2182b"
"""Colour of what is broken, in every picture."""

# Okabe and Ito's palette without its yellow, which is too light for lines.
_PALETTE = ("#000000", "#E69F00", "#D55E00", "#56B4E9", "#0072B2", "#009E73", "#CC79A7")
_MARKERS = ("o", "^", "s", "v", "D", "P", "X")
_KNOWN = ("undeformed", "moderate_AT", "severe_AT", "moderate_TA", "severe_TA")

# Twice as fast as the default, files 10 % larger.
_PNG = {"compress_level": 3}

_RC: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.labelsize": 9.0,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "axes.edgecolor": INK,
    "lines.linewidth": 1.4,
    "lines.markersize": 5.0,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "svg.fonttype": "path",
    "svg.hashsalt": "pearlite_petsc",
}


@dataclass(frozen=True, slots=True)
class StateStyle:
    """How a state is drawn everywhere."""

    colour: str
    marker: str
    label: str


def state_styles(names: Sequence[str]) -> dict[str, StateStyle]:
    """Return the style of each state; the source's five always look the same."""
    free = [i for i in range(len(_PALETTE)) if i >= len(_KNOWN) or _KNOWN[i] not in names]
    free = [*[i for i in free if i >= len(_KNOWN)], *[i for i in free if i < len(_KNOWN)]]
    styles = {}
    others = 0
    for name in names:
        if name in _KNOWN:
            place = _KNOWN.index(name)
        else:
            place = free[others % len(free)]
            others += 1
        styles[name] = StateStyle(_PALETTE[place], _MARKERS[place], state_label(name))
    return styles


def state_label(name: str) -> str:
    """Return a state's name for readers: ``severe_AT`` is "severe A-T"."""
    words = {"AT": "A-T", "TA": "T-A"}
    return " ".join(words.get(word, word) for word in name.split("_"))


@contextmanager
def drawing(
    path: Path, width: float = WIDTH, height: float = 4.5, pictures: bool = False
) -> Iterator[Figure]:
    """Yield a figure and write it as ``<path>.png`` and ``<path>.svg`` at the end.

    Args:
        path: Without suffix.
        width, height: [inch].
        pictures: The panels keep their own aspect; they move together and the rest is cut off.
    """
    with matplotlib.rc_context(_RC):
        figure = Figure(figsize=(width, height), dpi=DPI)
        FigureCanvasAgg(figure)
        figure.set_layout_engine("compressed" if pictures else "constrained")
        yield figure
        # A layout found once serves both files; finding it is most of the cost of a figure.
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        _write(figure, path, figure.get_tightbbox().padded(0.04) if pictures else None)


@contextmanager
def on_axes(axes: Axes | None, width: float = 4.8, height: float = 4.2) -> Iterator[Axes]:
    """Yield axes to draw on in the common look: the user's, or those of a new figure.

    Args:
        axes: The user's, or None.
        width, height: Of a new figure [inch].
    """
    # Here, because pyplot chooses a window system, which nothing that only writes files needs.
    from matplotlib import pyplot

    with matplotlib.rc_context(_RC):
        if axes is None:
            _, axes = pyplot.subplots(figsize=(width, height), dpi=110, layout="constrained")
        yield axes


def light_grid(axes: Axes) -> None:
    """Put a grid behind the data that is as light on a user's axes as on the program's own."""
    axes.grid(True, color=_RC["grid.color"], linewidth=_RC["grid.linewidth"])
    axes.set_axisbelow(True)


def _write(figure: Figure, path: Path, cut: Bbox | None) -> None:
    date = {"Date": None}
    png, svg = (path.with_name(path.name + suffix) for suffix in (".png", ".svg"))
    with whole_file(png) as partial:
        if cut is None:
            # Straight to the canvas: savefig draws everything once more to find its limits.
            FigureCanvasAgg(figure).print_png(partial, pil_kwargs=_PNG)
        else:
            figure.savefig(partial, dpi=DPI, format="png", bbox_inches=cut, pil_kwargs=_PNG)
    with whole_file(svg) as partial:
        if cut is None:
            FigureCanvasSVG(figure).print_svg(partial, metadata=date)
        else:
            figure.savefig(partial, dpi=DPI, format="svg", bbox_inches=cut, metadata=date)


def legend_below(figure: Any, handles: Sequence[Any], columns: int) -> None:
    """Put one legend under all panels, out of the way of the data."""
    rows = -(-len(handles) // columns)
    share = (0.19 * rows + 0.08) / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0.0, share, 1.0, 1.0 - share))
    figure.legend(handles=handles, loc="lower center", ncol=columns)


def label_outer(grid: Any, panels: int, x: str, y: str) -> None:
    """Name the axes at the left and at the foot of each column of panels.

    Args:
        grid: Axes; (rows, columns).
        panels: Axes in use, counted along the rows.
        x, y: Labels.
    """
    _rows, columns = grid.shape
    for place, axes in enumerate(grid.flat[:panels]):
        if place % columns == 0:
            axes.set_ylabel(y)
        if place + columns >= panels:
            axes.set_xlabel(x)
            axes.tick_params(labelbottom=True)


def grid_shape(count: int, most: int = 3) -> tuple[int, int]:
    """Return rows and columns for that many panels, at most ``most`` side by side."""
    columns = max(1, min(count, most))
    return -(-max(count, 1) // columns), columns
