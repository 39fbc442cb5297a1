"""Crack length over cycles, and tortuosity (figure 14 of the source)."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.lines import Line2D
from matplotlib.ticker import NullLocator

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.growth_rate import advances
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.output.figures.style import (
    INK,
    MOST_NAMED,
    WIDTH,
    drawing,
    grid_shape,
    label_outer,
    legend_below,
    light_grid,
    state_label,
    state_styles,
)
from pearlite_petsc.output.figures.ticks import DELTA_K_LABEL, plain_ticks
from pearlite_petsc.output.statistics import counts
from pearlite_petsc.output.tables import MPA_SQRT_UM, UM_PER_M, delta_k_in_mpa_sqrt_m


def draw_growth(path: Path, outcomes: Sequence[Outcome], states: Sequence[str]) -> None:
    """Draw a over N, one panel a state, one colour a delta_k, one line a mesh.

    Args:
        path: Without suffix.
        outcomes: Tasks with histories.
        states: Names in order.
    """
    states = [name for name in states if any(o.state == name for o in outcomes)]
    levels = sorted({o.delta_k for o in outcomes})
    named = len(levels) <= MOST_NAMED
    shades = np.linspace(0.0, 0.9, max(len(levels), 1))
    if not named:
        logs = np.log(levels)
        shades = 0.9 * (logs - logs[0]) / (logs[-1] - logs[0])
    colours = matplotlib.colormaps["viridis"](shades)
    rows, columns = grid_shape(len(states))
    with drawing(path, WIDTH, 2.2 * rows + (0.4 if named else 0.9)) as figure:
        grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        for axes in grid.flat[len(states) :]:
            axes.axis("off")
        for axes, state in zip(grid.flat, states, strict=False):
            for outcome in outcomes:
                if outcome.state != state or outcome.history is None:
                    continue
                cycles, length = outcome.history[:, 0], outcome.history[:, 1]
                grown = cycles > 0.0
                axes.plot(
                    cycles[grown],
                    length[grown],
                    color=colours[levels.index(outcome.delta_k)],
                    linewidth=0.9,
                    drawstyle="steps-post",
                )
            axes.set(xscale="log", title=state_label(state))
            axes.xaxis.set_minor_locator(NullLocator())
            axes.grid(True)
        label_outer(grid, len(states), "cycles N", "crack length a [µm]")
        if not named:
            _bar_of_levels(figure, grid, levels)
            return
        handles = [
            Line2D(
                [], [], color=colours[place], label=f"ΔK = {delta_k_in_mpa_sqrt_m(level):g} MPa√m"
            )
            for place, level in enumerate(levels)
        ]
        legend_below(figure, handles, min(max(len(handles), 1), 6))


def _bar_of_levels(figure: Any, grid: Any, levels: Sequence[float]) -> None:
    """Put a colour bar of Delta-K below the panels, where a legend would be too long."""
    viridis = ListedColormap(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, 256)))
    ends = [level / MPA_SQRT_UM for level in (levels[0], levels[-1])]
    shade = ScalarMappable(LogNorm(*ends), viridis)
    bar = figure.colorbar(shade, ax=grid, location="bottom", fraction=0.05, aspect=40.0)
    bar.set_label(DELTA_K_LABEL)
    plain_ticks(bar.ax)


def show_history(
    axes: Any, cycles: FloatArray, length: FloatArray, label: str, rate: float
) -> None:
    """Put one crack's length over its cycles and the straight line of its rate into the axes.

    Args:
        axes: Where to draw.
        cycles: N, ascending; (h,).
        length: Crack length a [um]; (h,).
        label: Of the crack.
        rate: da/dN, least-squares slope of the points at which the crack grew [um/cycle]; NaN
            leaves the line out.
    """
    (line,) = axes.step(cycles, length, where="post", label=label)
    if np.isfinite(rate):
        grown = advances(length)
        middle = cycles[grown].mean(), length[grown].mean()
        axes.plot(cycles[grown], length[grown], "o", color=line.get_color(), markersize=3.0)
        ends = cycles[[0, -1]]
        text = f"da/dN = {rate / UM_PER_M:.3g} m/cycle"
        axes.plot(ends, middle[1] + rate * (ends - middle[0]), "--", color=INK, lw=0.9, label=text)
    axes.set(xlabel="cycles N", ylabel="crack length a [µm]")
    axes.ticklabel_format(axis="x", style="sci", scilimits=(-3, 4), useMathText=True)
    axes.set_xlim(left=0.0)
    light_grid(axes)
    axes.legend(loc="upper left")


def draw_tortuosity(path: Path, outcomes: Sequence[Outcome], states: Sequence[str]) -> None:
    """Draw the tortuosity of each state: every crack, mean and standard deviation over meshes.

    A mesh counts once, with the mean over the delta_k at which its crack grew to the wanted
    extension; the others are hollow.

    Args:
        path: Without suffix.
        outcomes: Tasks; those without a tortuosity are left out.
        states: Names in order.
    """
    styles = state_styles(states)
    levels = sorted({o.delta_k for o in outcomes})
    with drawing(path, 5.6, 3.4) as figure:
        axes = figure.subplots()
        for place, state in enumerate(states):
            style = styles[state]
            own = [
                (o.mesh_index, levels.index(o.delta_k), o.tortuosity, counts(o))
                for o in outcomes
                if o.state == state and o.tortuosity is not None
            ]
            for grown in (True, False):
                shown = [
                    (place + 0.3 * (level + 0.5) / len(levels), value)
                    for _, level, value, yes in own
                    if yes is grown
                ]
                _draw_cracks(axes, shown, style.colour, grown)
            values = [
                np.mean([value for mesh, _, value, yes in own if yes and mesh == index])
                for index in sorted({mesh for mesh, _, _, yes in own if yes})
            ]
            if values:
                spread = np.std(values, ddof=1) if len(values) > 1 else 0.0
                axes.errorbar(
                    place - 0.12,
                    np.mean(values),
                    yerr=spread,
                    fmt=style.marker,
                    color=style.colour,
                    capsize=3.0,
                )
        axes.axhline(1.0, color="#8c8c8c", linewidth=0.8)
        axes.set_xticks(range(len(states)), [styles[state].label for state in states])
        axes.set_xlim(-0.5, len(states) - 0.4)
        axes.set_ylabel("tortuosity: path length / extent in x")
        axes.grid(True, axis="y")
        if levels:
            low, high = levels[0] / MPA_SQRT_UM, levels[-1] / MPA_SQRT_UM
            axes.set_title(
                f"mark: mean ± standard deviation over meshes; small: cracks, hollow those that ended "
                f"early;\nΔK {low:g} to {high:g} MPa√m from left to right in each state",
                fontsize=7.5,
                loc="left",
            )


def _draw_cracks(
    axes: Axes, points: Sequence[tuple[float, float]], colour: str, grown: bool
) -> None:
    """Draw the tortuosity of single cracks, small; hollow where they ended early."""
    axes.plot(
        [x for x, _ in points],
        [y for _, y in points],
        "o",
        color=colour,
        markerfacecolor=colour if grown else "none",
        alpha=0.5 if grown else 0.9,
        markersize=2.5,
        markeredgewidth=0.6,
    )
