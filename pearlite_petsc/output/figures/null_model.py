"""Growth rates of the states relative to one of them, beside the model without a microstructure."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.output.figures.style import (
    GREY,
    INK,
    StateStyle,
    drawing,
    legend_below,
    state_styles,
)
from pearlite_petsc.output.figures.ticks import DELTA_K_LABEL, plain_ticks
from pearlite_petsc.output.null_model import null_ratio
from pearlite_petsc.output.statistics import common_levels, rate_ratio
from pearlite_petsc.output.tables import MPA_SQRT_UM
from pearlite_petsc.scene import State

BOUND_LABEL = "upper bound (window's edge)"


def draw_null_model(path: Path, outcomes: Sequence[Outcome], states: Sequence[State]) -> None:
    """Draw rates relative to the first state: simulated (marks) and null model (lines).

    What lies between mark and line is the microstructure's part; the line is put in by hand with
    yield stress and threshold. Only delta_k at which every mesh of both states grew are marked;
    hollow where cracks that ran into the window's boundary are among them.

    Args:
        path: Without suffix.
        outcomes: Tasks of one scene.
        states: The scene's states; the first is the reference.
    """
    styles = state_styles([state.name for state in states])
    every = sorted({o.delta_k for o in outcomes})
    with drawing(path, 5.6, 4.2) as figure:
        axes = figure.subplots()
        axes.axhline(1.0, color=INK, linewidth=0.8)
        bounded = False
        for place, state in enumerate(states[1:]):
            style = styles[state.name]
            if not any(o.state == state.name for o in outcomes):
                continue
            shift = 1.0 + 0.012 * (place - 0.5 * (len(states) - 2))
            axes.plot([], [], style.marker, color=style.colour, label=style.label)
            bounded |= _ratios(axes, outcomes, state.name, states[0].name, style, shift)
            fine = np.geomspace(every[0], every[-1], 60)
            dash = (0.0 if state.orientation == "AT" else 4.0, (4.0, 4.0))
            expected = null_ratio(fine, state, states[0])
            axes.plot(fine / MPA_SQRT_UM, expected, linestyle=dash, color=style.colour)
        if bounded:
            axes.plot([], [], "o", color=GREY, markerfacecolor="white", label=BOUND_LABEL)
        axes.plot([], [], "--", color=GREY, label="null model: no microstructure")
        axes.set(xscale="log", yscale="log", xlabel=DELTA_K_LABEL)
        axes.set_ylabel(f"da/dN relative to {styles[states[0].name].label}")
        plain_ticks(axes, [level / MPA_SQRT_UM for level in every])
        _plain_ratios(axes)
        axes.grid(True)
        legend_below(figure, axes.get_legend_handles_labels()[0], 3)


def _ratios(
    axes: Any,
    outcomes: Sequence[Outcome],
    name: str,
    other: str,
    style: StateStyle,
    shift: float,
) -> bool:
    """Mark the ratio at each common level; return whether an upper bound is among them."""
    levels = sorted({o.delta_k for o in outcomes})
    exact = common_levels(outcomes, name, other, levels)
    shown = common_levels(outcomes, name, other, levels, bounds=True)
    for level in shown:
        ratio = rate_ratio(outcomes, name, other, [level], bounds=True)
        ends = [abs(ratio.value - end) for end in (ratio.low, ratio.high)]
        axes.errorbar(
            level / MPA_SQRT_UM * shift,
            ratio.value,
            yerr=np.nan_to_num(np.array(ends)[:, None]),
            fmt=style.marker,
            color=style.colour,
            markerfacecolor=style.colour if level in exact else "white",
            capsize=2.5,
            elinewidth=0.9,
        )
    return exact != shown


def _plain_ratios(axes: Any) -> None:
    low, high = axes.get_ylim()
    ticks = [m * 10.0**e for e in range(-4, 5) for m in (1, 2, 5) if low <= m * 10.0**e <= high]
    axes.yaxis.set_major_locator(FixedLocator(ticks))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_locator(NullLocator())
