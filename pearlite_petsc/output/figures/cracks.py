"""Crack paths in the microstructure (figure 13 of the source) and the damage round a crack."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import ListedColormap, Normalize

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.output.figures.microstructure import LabelRaster, is_legible, show_raster
from pearlite_petsc.output.figures.style import (
    BROKEN,
    GREY,
    INK,
    MOST_NAMED,
    WIDTH,
    drawing,
    grid_shape,
    label_outer,
    state_label,
    state_styles,
)
from pearlite_petsc.output.snapshot import Snapshot
from pearlite_petsc.scene import Kind

# From a yellow that is seen on light ground.
DAMAGE_COLOURS = ListedColormap(matplotlib.colormaps["YlOrRd"](np.linspace(0.25, 1.0, 256)))


@dataclass(frozen=True, slots=True, eq=False)
class PathLine:
    """One crack path: its way [um] (p, 2), and what its colour stands for."""

    label: str
    path: FloatArray


def draw_paths(
    path: Path,
    paths: Mapping[str, Sequence[PathLine]],
    window: tuple[float, float],
    title: str,
) -> None:
    """Draw all paths of each state over one another, source figure 13.

    Args:
        path: Without suffix.
        paths: State -> paths of its meshes.
        window: Width and height [um].
        title: What the paths have in common.
    """
    styles = state_styles(list(paths))
    points = [line.path for lines in paths.values() for line in lines]
    everything = np.concatenate(points) if points else np.array([[0.0, 0.5 * window[1]]])
    reach = float(np.abs(everything[:, 1] - 0.5 * window[1]).max()) + 6.0
    left, right = everything[:, 0].min() - 8.0, everything[:, 0].max() + 6.0
    slenderness = 2.0 * reach / (right - left)
    rows, columns = grid_shape(len(paths), most=3 if slenderness < 1.2 else 5)
    height = (0.9 * WIDTH / columns * slenderness + 0.45) * rows + 0.6
    with drawing(path, WIDTH, height, pictures=True) as figure:
        grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        for axes in grid.flat[len(paths) :]:
            axes.axis("off")
        for axes, (state, lines) in zip(grid.flat, paths.items(), strict=False):
            for line in lines:
                axes.plot(*line.path.T, color=styles[state].colour, linewidth=1.1, alpha=0.85)
            axes.plot([left, everything[0, 0]], [0.5 * window[1]] * 2, color=INK, linewidth=2.0)
            meshes = f"{len(lines)} mesh{'' if len(lines) == 1 else 'es'}"
            axes.set_title(f"{styles[state].label}\n{meshes}")
            axes.set(xlim=(left, right), aspect="equal")
            axes.set_ylim(0.5 * window[1] - reach, 0.5 * window[1] + reach)
            axes.grid(True)
        figure.suptitle(title, fontsize=9.0)
        label_outer(grid, len(paths), "x [µm]", "y [µm]")


def draw_state_path(
    path: Path,
    state: str,
    raster: LabelRaster,
    paths: Sequence[PathLine],
    notch: tuple[float, float],
    index: int,
    last: Snapshot | None = None,
    last_delta_k: str = "",
) -> None:
    """Draw a state's crack paths in one mesh's microstructure, and the damage round one of them.

    Args:
        path: Without suffix.
        state: Name.
        raster: Labels of the part of the window to show.
        paths: Cracks of that mesh; colours from dark to light in this order.
        notch: Tip of the notch [um].
        index: Number of the mesh.
        last: Last step of a crack in that mesh, for the damage; None leaves that picture out.
        last_delta_k: Delta-K of that crack as text.
    """
    left, right, bottom, top = raster.extent
    panels = 1 if last is None else 2
    height = WIDTH / panels * (top - bottom) / (right - left)
    with drawing(path, WIDTH, height + 0.6, pictures=True) as figure:
        grid = figure.subplots(1, panels, squeeze=False)[0]
        content = show_paths(grid[0], raster, paths, notch)
        grid[0].set_title(f"{state_label(state)}: crack paths in mesh {index}")
        if last is not None:
            show_damage(grid[1], last, deformed=False)
            grid[1].set(xlim=(left, right), ylim=(bottom, top))
            at = f" at {last_delta_k}" if last_delta_k else ""
            grid[1].set_title(f"damage after {last.cycles:,.0f} cycles{at}")
            colour_bar(figure, grid[1])
        grid[0].set_xlabel(f"{right - left:.0f} µm wide; {content}")


def show_paths(
    axes: Any, raster: LabelRaster, paths: Sequence[PathLine], notch: tuple[float, float]
) -> str:
    """Put crack paths in their microstructure into the axes; return what the picture shows of it.

    Args:
        axes: Where to draw.
        raster: Labels of the part of the window to show.
        paths: Cracks of that mesh; colours from dark to light in this order.
        notch: Tip of the notch [um].
    """
    left, right, bottom, top = raster.extent
    content = _show_microstructure(axes, raster)
    colours = matplotlib.colormaps["plasma"](np.linspace(0.0, 0.75, max(len(paths), 1)))
    axes.plot([left, notch[0]], [notch[1]] * 2, color=INK, linewidth=3.0, label="notch")
    # Wide first, so that paths that agree still show one under the other.
    widths = np.linspace(4.0 if len(paths) > 1 else 1.6, 1.2, max(len(paths), 1))
    # Of many paths only some are named: each more would hide a part of the picture.
    every = -(-len(paths) // MOST_NAMED)
    for place, (colour, width, line) in enumerate(zip(colours, widths, paths, strict=False)):
        label = line.label if place % every == 0 or place == len(paths) - 1 else None
        axes.plot(*line.path.T, color=colour, linewidth=width, label=label)
    axes.set(xlim=(left, right), ylim=(bottom, top))
    if paths:
        axes.legend(loc="upper left", frameon=True, framealpha=0.85)
    return content


def _show_microstructure(axes: Any, raster: LabelRaster) -> str:
    """Put what the raster resolves of the microstructure into the axes; return what that is."""
    if is_legible(raster.colony):
        borders = [raster.colony, raster.prior_austenite_grain]
        show_raster(axes, raster, raster.block, borders, hatch=0.25)
        return "tints: blocks, hatching: lamellae"
    # Severe shear draws colonies out to lines thinner than a pixel.
    show_raster(axes, raster, raster.prior_austenite_grain, hatch=0.0)
    return "tints: prior austenite grains"


def show_damage(axes: Any, step: Snapshot, deformed: bool, magnify: float = 1.0) -> None:
    """Put elements, damaged and broken interfaces into the axes.

    Args:
        axes: Where to draw.
        step: What to draw.
        deformed: Show the elements where the load moves them; interfaces stay undamaged lines then.
        magnify: Factor on the displacement.
    """
    points = step.points + (magnify * step.displacement if deformed else 0.0)
    axes.add_collection(
        PolyCollection(
            list(points[step.triangles]),
            facecolors="#f2f0eb",
            edgecolors="#f2f0eb",
            linewidths=0.2,
            rasterized=True,
        )
    )
    if not deformed:
        intact = ~step.broken & (step.kind != Kind.NOTCH)
        order = np.argsort(step.damage[intact])
        damage = step.damage[intact][order]
        axes.add_collection(
            LineCollection(
                list(step.segments[intact][order]),
                colors=_damage_colours(damage),
                linewidths=0.3 + 1.4 * damage,
                rasterized=True,
            )
        )
        cut = step.broken
        axes.add_collection(LineCollection(list(step.segments[cut]), colors=BROKEN, linewidths=1.8))
        notch = step.kind == Kind.NOTCH
        axes.add_collection(LineCollection(list(step.segments[notch]), colors=INK, linewidths=2.6))
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(True)
        spine.set_edgecolor(GREY)


def _damage_colours(damage: FloatArray) -> FloatArray:
    """Return the colour of each intact interface, grey where there is next to no damage."""
    colours = np.asarray(DAMAGE_COLOURS(damage))
    colours[damage < 0.02] = (0.82, 0.82, 0.82, 1.0)
    return colours


def colour_bar(figure: Any, axes: Any) -> None:
    """Put the scale of the damage beside the axes."""
    scale = ScalarMappable(Normalize(0.0, 1.0), DAMAGE_COLOURS)
    bar = figure.colorbar(scale, ax=axes, shrink=0.75, pad=0.02)
    bar.set_label("damage D of intact interfaces; dark red: broken")
