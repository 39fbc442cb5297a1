"""Chart of what a method costs over the size of its problem."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from pearlite_petsc.output.figures.style import INK, WIDTH, drawing, label_outer, legend_below

_COLOURS = ("#D55E00", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#0072B2")
_MARKS = ("s", "^", "D", "v", "P", "X")


def draw_times(
    path: Path,
    panels: Mapping[str, Mapping[str, Sequence[tuple[float, float]]]],
    x_label: str,
    y_label: str,
    dashed: Collection[str] = (),
) -> None:
    """Draw time over size on log axes, the first series of all in black with the rest beside.

    Args:
        path: Without suffix.
        panels: Title -> series -> (size, time) by rising size, both > 0.
        x_label, y_label: With units.
        dashed: Series that are the first one under other circumstances; their marks are hollow.
    """
    names = list(dict.fromkeys(name for series in panels.values() for name in series))
    others = [name for name in names[1:] if name not in dashed]
    with drawing(path, WIDTH, 3.9) as figure:
        grid = figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)
        lines = {}
        for axes, (title, series) in zip(grid.flat, panels.items(), strict=True):
            for name, points in series.items():
                own = name not in others
                place = 0 if own else others.index(name)
                (lines[name],) = axes.plot(
                    *zip(*points, strict=True),
                    marker="o" if own else _MARKS[place % len(_MARKS)],
                    markerfacecolor="white" if name in dashed else None,
                    color=INK if own else _COLOURS[place % len(_COLOURS)],
                    linestyle="--" if name in dashed else "-",
                    linewidth=2.0 if own else 1.2,
                    zorder=3 if own else 2,
                    label=name,
                )
            axes.set(xscale="log", yscale="log", title=title)
            axes.grid(True, which="major")
        label_outer(grid, len(panels), x_label, y_label)
        legend_below(figure, [lines[name] for name in names], -(-len(names) // 2))
