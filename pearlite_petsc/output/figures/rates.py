"""Growth rate curves (figures 11, 12, 15 of the source)."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.markers import CARETDOWN

from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.experiment import MeasuredPoint
from pearlite_petsc.output.figures.style import (
    GREY,
    StateStyle,
    drawing,
    legend_below,
    light_grid,
    state_styles,
)
from pearlite_petsc.output.figures.ticks import DELTA_K_LABEL, plain_ticks
from pearlite_petsc.output.literature import (
    GROWTH_LAWS,
    RAIL_LIMITS,
    RAIL_LIMITS_RATIO,
    rail_limits_name,
)
from pearlite_petsc.output.statistics import (
    RateCurve,
    counts,
    rate_curves,
)
from pearlite_petsc.output.tables import MPA_SQRT_UM, UM_PER_M
from pearlite_petsc.scene import State

EARLY_LABEL = "ended before the full extension"
ARRESTED_LABEL = "arrested, no rate"
PART_LABEL = "not all meshes grew"
RATE_LABEL = "da/dN [m/cycle]"


def draw_rates(
    path: Path,
    outcomes: Sequence[Outcome],
    states: Sequence[State],
    measured: Sequence[MeasuredPoint] = (),
    load_ratio: float = RAIL_LIMITS_RATIO,
) -> None:
    """Draw da/dN over Delta-K, one panel for each shear plane (undeformed in both).

    Filled marks: geometric mean over the meshes; bars: geometric standard deviation; half-filled
    and dashed: mean over those that grew to the wanted extension where others did not; small:
    single meshes; hollow: tasks that ended otherwise; arrows at the foot: arrested ones, which have
    no rate. Vertical lines: thresholds. Grey: literature. Crosses: measured points, arrows: run-outs.

    Args:
        path: Without suffix.
        outcomes: Tasks of one scene.
        states: The scene's states in order.
        measured: User's points; states that the scene does not have are drawn grey.
        load_ratio: R of the tasks; another than that of the drawn limits is said beside them.
    """
    panels = _panels(states)
    with drawing(path, 3.7 * max(len(panels), 1.5), 4.9) as figure:
        grid = figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0]
        for axes, (title, names) in zip(grid, panels, strict=True):
            axes.set_title(title)
            _fill(axes, outcomes, states, names, measured)
        _finish(grid, outcomes, states, measured, load_ratio)
        legend_below(figure, _handles(grid, states), 3 if len(panels) > 1 else 2)


def show_rates(
    axes: Any,
    outcomes: Sequence[Outcome],
    states: Sequence[State],
    measured: Sequence[MeasuredPoint] = (),
    room_below: bool = False,
) -> None:
    """Put da/dN over Delta-K of all states into one picture; marks as in ``draw_rates``.

    Args:
        axes: Where to draw.
        outcomes: Tasks of one scene.
        states: The scene's states in order.
        measured: User's points.
        room_below: Whether there is room below the axes; else the legend lies where data leave it.
    """
    _fill(axes, outcomes, states, [state.name for state in states], measured)
    _finish([axes], outcomes, states, measured)
    handles = _handles([axes], states)
    if room_below:
        axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2)
    else:
        axes.legend(handles=handles, loc="best", fontsize=6.0, frameon=True, framealpha=0.9)


def _fill(
    axes: Any,
    outcomes: Sequence[Outcome],
    states: Sequence[State],
    names: Sequence[str],
    measured: Sequence[MeasuredPoint],
) -> None:
    """Put some of the states into a panel."""
    styles = state_styles([state.name for state in states])
    curves = {curve.state: curve for curve in rate_curves(outcomes, list(styles))}
    axes.set(xscale="log", yscale="log", xlabel=DELTA_K_LABEL)
    for place, name in enumerate(names):
        if name in curves:
            shift = 1.0 + 0.012 * (place - 0.5 * (len(names) - 1))
            _curve(axes, curves[name], styles[name], shift)
            _single(axes, outcomes, name, styles[name], shift)
            _arrested(axes, outcomes, name, styles[name], shift)
    _thresholds(axes, [state for state in states if state.name in names], styles)
    _measured(axes, measured, styles, names)


def _finish(
    panels: Sequence[Any],
    outcomes: Sequence[Outcome],
    states: Sequence[State],
    measured: Sequence[MeasuredPoint],
    load_ratio: float = RAIL_LIMITS_RATIO,
) -> None:
    """Give panels that share their axes limits, literature, ticks and names."""
    low, high = _range(outcomes, states, measured)
    for axes in panels:
        axes.set_xlim(low, high)
        _literature(axes, low, high, load_ratio)
        plain_ticks(axes)
        light_grid(axes)
    if any(_stopped(o) for o in outcomes):
        # Room for the marks at the axis below the slowest crack.
        bottom, top = panels[0].get_ylim()
        panels[0].set_ylim(bottom * (bottom / top) ** 0.05, top)
    panels[0].set_ylabel(RATE_LABEL)


def _handles(panels: Sequence[Any], states: Sequence[State]) -> list[Any]:
    """Return what a legend of the panels shows: states first, each label once."""
    handles = {label: handle for axes in panels for handle, label in _legend(axes)}
    styles = state_styles([state.name for state in states])
    first = [style.label for style in styles.values() if style.label in handles]
    return [handles[label] for label in dict.fromkeys([*first, *handles])]


def _panels(states: Sequence[State]) -> list[tuple[str, list[str]]]:
    common = [s.name for s in states if s.shear_strain == 0.0]
    panels = []
    for orientation, title in (("AT", "A-T"), ("TA", "T-A")):
        own = [s.name for s in states if s.shear_strain != 0.0 and s.orientation == orientation]
        if own:
            panels.append((title, [*common, *own]))
    return panels or [("", common)]


def _curve(axes: Any, curve: RateCurve, style: StateStyle, shift: float) -> None:
    good = np.isfinite(curve.mean)
    x = curve.delta_k / MPA_SQRT_UM * shift
    mean = curve.mean / UM_PER_M
    factor = np.where(np.isfinite(curve.factor), curve.factor, 1.0)
    whole = curve.grown == curve.tasks
    for chosen, fill in ((good & whole, "full"), (good & ~whole, "bottom")):
        axes.errorbar(
            x[chosen],
            mean[chosen],
            yerr=(mean * np.stack([1.0 - 1.0 / factor, factor - 1.0]))[:, chosen],
            fmt=style.marker,
            fillstyle=fill,
            markerfacecoloralt="white",
            color=style.colour,
            capsize=2.5,
            elinewidth=0.9,
            zorder=4,
        )
    for left in np.flatnonzero(good)[:-1]:
        pair = [left, left + 1 + np.flatnonzero(good[left + 1 :])[0]]
        dash = "-" if whole[pair].all() else ":"
        axes.plot(x[pair], mean[pair], dash, color=style.colour, zorder=3)
    axes.plot([], [], style.marker + "-", color=style.colour, label=style.label)
    if (good & ~whole).any():
        half = {"fillstyle": "bottom", "markerfacecoloralt": "white"}
        axes.plot([], [], "o:", color=GREY, label=PART_LABEL, **half)


def _single(
    axes: Any, outcomes: Sequence[Outcome], name: str, style: StateStyle, shift: float
) -> None:
    own = [o for o in outcomes if o.state == name and o.da_dn > 0.0 and not _stopped(o)]
    for grown in (True, False):
        shown = [o for o in own if counts(o) is grown]
        axes.plot(
            [o.delta_k / MPA_SQRT_UM * shift for o in shown],
            [o.da_dn / UM_PER_M for o in shown],
            style.marker,
            color=style.colour,
            markersize=2.5 if grown else 4.5,
            markerfacecolor=style.colour if grown else "none",
            alpha=0.45 if grown else 0.9,
            linestyle="none",
        )
    if any(not counts(o) for o in own):
        axes.plot([], [], "o", color=GREY, markerfacecolor="none", label=EARLY_LABEL)


def _stopped(outcome: Outcome) -> bool:
    return outcome.stop_reason is StopReason.ARRESTED


def _arrested(
    axes: Any, outcomes: Sequence[Outcome], name: str, style: StateStyle, shift: float
) -> None:
    """Point at the axis where cracks arrested: they have no place on the scale of rates."""
    levels = sorted({o.delta_k for o in outcomes if o.state == name and _stopped(o)})
    if not levels:
        return
    mark = {"marker": CARETDOWN, "markersize": 6.0, "linestyle": "none"}
    # Side by side, so that states at the same load do not hide each other.
    x = [level / MPA_SQRT_UM * shift**3 for level in levels]
    across = axes.get_xaxis_transform()
    (line,) = axes.plot(x, [0.0] * len(x), color=style.colour, transform=across, zorder=5, **mark)
    line.set_clip_on(False)
    line.set_in_layout(False)
    axes.plot([], [], color=GREY, label=ARRESTED_LABEL, **mark)


def _legend(axes: Any) -> list[tuple[Any, str]]:
    return list(zip(*axes.get_legend_handles_labels(), strict=True))


def _thresholds(axes: Any, states: Sequence[State], styles: dict[str, StateStyle]) -> None:
    for state in states:
        if state.delta_k_th > 0.0:
            x, colour = state.delta_k_th / MPA_SQRT_UM, styles[state.name].colour
            axes.axvline(x, color=colour, linewidth=0.9, linestyle=":", zorder=1)
    if any(state.delta_k_th > 0.0 for state in states):
        axes.plot([], [], ":", color=GREY, linewidth=0.9, label=r"thresholds $\Delta K_{th}$")


def _literature(axes: Any, low: float, high: float, load_ratio: float) -> None:
    x = np.geomspace(low, high, 30)
    for law, dash in zip(GROWTH_LAWS, ("-", "-."), strict=True):
        axes.plot(x, law.rate(x), dash, color=GREY, linewidth=0.9, zorder=1, label=law.name)
    axes.plot(
        [limit.delta_k for limit in RAIL_LIMITS],
        [limit.rate for limit in RAIL_LIMITS],
        "*",
        color=GREY,
        markersize=8.0,
        zorder=2,
        label=rail_limits_name(load_ratio),
    )


def _measured(
    axes: Any,
    measured: Sequence[MeasuredPoint],
    styles: dict[str, StateStyle],
    names: Sequence[str],
) -> None:
    shown = [p for p in measured if p.state in names or p.state not in styles]
    for state in sorted({p.state for p in shown}):
        colour = styles[state].colour if state in styles else GREY
        label = f"measured, {styles[state].label if state in styles else state}"
        for run_out, mark, end in ((False, "x", ""), (True, CARETDOWN, ", run-out")):
            points = [p for p in shown if p.state == state and p.run_out is run_out]
            if points:
                axes.plot(
                    [p.delta_k for p in points],
                    [p.da_dn for p in points],
                    linestyle="none",
                    marker=mark,
                    color=colour,
                    markersize=5.0,
                    zorder=5,
                    label=label + end,
                )


def _range(
    outcomes: Sequence[Outcome], states: Sequence[State], measured: Sequence[MeasuredPoint]
) -> tuple[float, float]:
    values = [o.delta_k / MPA_SQRT_UM for o in outcomes]
    values += [s.delta_k_th / MPA_SQRT_UM for s in states if s.delta_k_th > 0.0]
    values += [p.delta_k for p in measured]
    values = values or [limit.delta_k for limit in RAIL_LIMITS]
    return 0.85 * min(values), 1.18 * max(values)
