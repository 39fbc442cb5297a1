"""Charts of the method itself: elastic certificates, speed against accuracy, stability."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.output.figures.style import (
    BROKEN,
    GREY,
    INK,
    PALE,
    WIDTH,
    drawing,
    grid_shape,
)


@dataclass(frozen=True, slots=True)
class Setting:
    """One measured setting of the speed-accuracy chart.

    Attributes:
        label: What it is.
        series: Group with one colour and mark ("homogeneous, exponential").
        cost: Wall time [s], > 0.
        error: Relative error against the reference, >= 0.
        is_default: Whether the program uses it unless told otherwise.
        error_low, error_high: Confidence interval of the error, or None.
        counts: Whether it may be on the front; drawn hollow if not.
    """

    label: str
    series: str
    cost: float
    error: float
    is_default: bool = False
    error_low: float | None = None
    error_high: float | None = None
    counts: bool = True


def pareto_front(
    cost: FloatArray, error: FloatArray
) -> "np.ndarray[tuple[int], np.dtype[np.intp]]":
    """Return the settings that no other one beats in both cost and error, by rising cost."""
    order = np.lexsort((error, cost))
    best = np.minimum.accumulate(error[order])
    first = np.concatenate([[True], best[1:] < best[:-1]])
    return np.asarray(order[first])


COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
MARKS = ("o", "s", "^", "D", "v", "P", "X")
"""Of the series, in turn."""

LABEL_WIDTH, LABEL_HEIGHT = 75.0, 8.0
"""Room of a label on the front [points]."""


def draw_pareto(
    path: Path,
    settings: Sequence[Setting],
    cost_label: str = "wall time [s]",
    error_label: str = "error against the reference",
) -> None:
    """Draw error over cost on log axes with the Pareto front and the default setting.

    Args:
        path: Without suffix.
        settings: At least one.
        cost_label, error_label: With units.
    """
    names = list(dict.fromkeys(setting.series for setting in settings))
    cost = np.array([setting.cost for setting in settings])
    error = np.array([setting.error for setting in settings])
    positive = error[error > 0.0]
    floor = 0.5 * positive.min() if len(positive) else 1e-6
    shown = np.maximum(error, floor)
    counted = np.flatnonzero([setting.counts for setting in settings])
    front = counted[pareto_front(cost[counted], error[counted])]
    with drawing(path, WIDTH, 4.6) as figure:
        axes = figure.subplots()
        axes.step(cost[front], shown[front], where="post", color=GREY, label="Pareto front")
        for name, colour, mark in zip(names, cycle(COLOURS), cycle(MARKS), strict=False):
            own = [setting for setting in settings if setting.series == name]
            _draw_series(axes, name, own, floor, colour, mark)
        axes.set(xscale="log", yscale="log", xlabel=cost_label, ylabel=error_label)
        axes.margins(x=0.12)
        labels = [settings[place].label for place in front]
        _label_front(axes, labels, np.stack([cost[front], shown[front]], axis=1))
        for place, setting in enumerate(settings):
            if setting.is_default:
                axes.plot(
                    cost[place],
                    shown[place],
                    "o",
                    markersize=13,
                    markerfacecolor="none",
                    markeredgecolor=BROKEN,
                    label="default" if setting.label in names else f"default: {setting.label}",
                )
        if len(counted) < len(settings):
            axes.plot([], [], "s", color=GREY, fillstyle="none", label="other paths")
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.grid(True, which="both")
        axes.legend()


def _draw_series(
    axes: Axes, name: str, settings: Sequence[Setting], floor: float, colour: str, mark: str
) -> None:
    """Draw settings of one series with their intervals; hollow if they do not count."""
    # The circle round the default says its name.
    if not any(setting.is_default and setting.label == name for setting in settings):
        axes.plot([], [], mark, color=colour, label=name, alpha=0.85)
    for counts, fill in ((True, "full"), (False, "none")):
        some = [setting for setting in settings if setting.counts is counts]
        error = [max(setting.error, floor) for setting in some]
        axes.plot([s.cost for s in some], error, mark, color=colour, fillstyle=fill, alpha=0.85)
    for setting in settings:
        if setting.error_high is not None:
            low = max(setting.error_low or 0.0, floor)
            axes.plot([setting.cost] * 2, [low, setting.error_high], color=colour, lw=0.8)


def _label_front(axes: Axes, labels: Sequence[str], points: FloatArray) -> None:
    """Write names beside points (p, 2) by rising cost; those of near points one above the other."""
    placed: list[FloatArray] = []
    for label, point in zip(labels, points, strict=True):
        mark = axes.transData.transform(point) * 72.0 / axes.figure.dpi
        text = mark + np.full(2, 4.0)
        near = sorted(float(other[1]) for other in placed if abs(text[0] - other[0]) < LABEL_WIDTH)
        for height in near:
            if abs(text[1] - height) < LABEL_HEIGHT:
                text[1] = height + LABEL_HEIGHT
        placed.append(text)
        axes.annotate(label, point, xytext=text - mark, textcoords="offset points", fontsize=6.5)


OUTCOMES = ("converges", "falls back", "stops with a reason", "wrong or crashes")
"""What can happen in a stability study, from good to bad."""


def draw_stability(path: Path, studies: Mapping[str, Sequence[tuple[str, str, str]]]) -> None:
    """Draw what happens where, one row of coloured fields a study.

    Args:
        path: Without suffix.
        studies: Title -> points in order, each (value shown, one of ``OUTCOMES``, short remark).
    """
    colours = ListedColormap(["#009E73", "#E69F00", "#56B4E9", "#B2182B"])
    norm = BoundaryNorm(np.arange(len(OUTCOMES) + 1) - 0.5, colours.N)
    rows = max(len(studies), 1)
    with drawing(path, WIDTH, 0.85 * rows + 0.6) as figure:
        grid = figure.subplots(rows, 1, squeeze=False)[:, 0]
        for axes, (title, points) in zip(grid, studies.items(), strict=False):
            row = np.array([[OUTCOMES.index(outcome) for _, outcome, _ in points]])
            axes.imshow(row, cmap=colours, norm=norm, aspect="auto", alpha=0.75)
            for place, (_, _, remark) in enumerate(points):
                axes.text(place, 0, remark, ha="center", va="center", fontsize=6.5, color=INK)
            axes.set_xticks(range(len(points)), [value for value, _, _ in points])
            axes.set_yticks([])
            axes.set_title(title, loc="left", fontsize=8.0)
        for place, name in enumerate(OUTCOMES):
            grid[0].plot([], [], "s", color=colours(place), alpha=0.75, label=name)
        figure.legend(*grid[0].get_legend_handles_labels(), loc="upper right", ncols=4)


def draw_elastic(
    path: Path, certificates: Mapping[str, Mapping[str, float]], wanted: Mapping[str, float]
) -> None:
    """Draw measured elastic constants of meshes against what was wanted.

    Args:
        path: Without suffix.
        certificates: Mesh or setting -> constant ("E_x/E", "E_y/E", "nu", ...) -> measured value.
        wanted: Constant -> value of the homogeneous solid.
    """
    names = list(wanted)
    rows, columns = grid_shape(len(names))
    labels = list(certificates)
    with drawing(path, WIDTH, (0.8 + 0.17 * len(labels)) * rows) as figure:
        grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
        for axes in grid.flat[len(names) :]:
            axes.axis("off")
        for axes, name in zip(grid.flat, names, strict=False):
            values = np.array([certificates[label].get(name, np.nan) for label in labels])
            place = np.arange(len(labels))
            axes.hlines(place, wanted[name], values, color=PALE, linewidth=3.0)
            axes.axvline(wanted[name], color=GREY, linewidth=0.9)
            axes.plot(values, place, "o", color="#0072B2")
            finite = values[np.isfinite(values) & (values > 0.0)]
            if wanted[name] > 0.0 and len(finite) and finite.max() > 20.0 * finite.min():
                axes.set_xscale("log")
            axes.set_yticks(place, labels, fontsize=7.0)
            axes.invert_yaxis() if axes is grid.flat[0] else None
            axes.set_title(name)
            axes.grid(True, axis="x")
