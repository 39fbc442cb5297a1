"""Microstructure by level with lamella hatching, mesh with kinds, lamella angles (figure 3)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import Patch

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.output.figures.style import (
    INK,
    WIDTH,
    drawing,
    grid_shape,
    label_outer,
    legend_below,
    state_label,
    state_styles,
)
from pearlite_petsc.scene import Kind

# Soft tints that stay apart for colour-blind readers; neighbours are told apart by their borders.
_TINTS = np.array(
    [
        [0.84, 0.90, 0.95],
        [0.99, 0.91, 0.76],
        [0.83, 0.93, 0.88],
        [0.96, 0.87, 0.92],
        [0.93, 0.93, 0.93],
        [0.89, 0.86, 0.95],
        [0.98, 0.88, 0.82],
    ]
)
KIND_COLOURS = {
    Kind.LAMELLA: "#b8b8b8",
    Kind.CEMENTITE: "#56B4E9",
    Kind.COLONY: "#009E73",
    Kind.BLOCK: "#E69F00",
    Kind.PRIOR_AUSTENITE_GRAIN: "#CC79A7",
    Kind.NOTCH: INK,
}


@dataclass(frozen=True, slots=True, eq=False)
class LabelRaster:
    """Labels of the pixels of a window; row 0 at y = 0.

    Attributes:
        prior_austenite_grain, block, colony: Labels; (rows, columns).
        lamella_angle: [rad]; (rows, columns).
        extent: Left, right, bottom, top of the raster [um].
    """

    prior_austenite_grain: IntArray
    block: IntArray
    colony: IntArray
    lamella_angle: FloatArray
    extent: tuple[float, float, float, float]


LabelsOf = Callable[[FloatArray], tuple[IntArray, IntArray, IntArray]]


def label_raster(
    labels: LabelsOf,
    lamella_angle: FloatArray,
    extent: tuple[float, float, float, float],
    columns: int = 240,
) -> LabelRaster:
    """Return the labels of a picture's pixels.

    Args:
        labels: Prior austenite grain, block and colony of points (n, 2) [um].
        lamella_angle: Of each colony [rad].
        extent: Left, right, bottom, top [um].
        columns: Pixels along x; pixels are square.
    """
    left, right, bottom, top = extent
    rows = max(1, round(columns * (top - bottom) / (right - left)))
    x = left + (np.arange(columns) + 0.5) * (right - left) / columns
    y = bottom + (np.arange(rows) + 0.5) * (top - bottom) / rows
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    grain, block, colony = (label.reshape(rows, columns) for label in labels(points))
    return LabelRaster(grain, block, colony, lamella_angle[colony], extent)


def hatched(raster: LabelRaster, tint_by: IntArray, hatch: float = 0.18) -> FloatArray:
    """Return the picture of a raster: tinted labels, lamellae as stripes; (rows, columns, 3).

    Args:
        raster: Labels.
        tint_by: Labels that choose the tint; (rows, columns).
        hatch: Depth of the stripes, 0 for none.
    """
    rows, columns = tint_by.shape
    left, right, bottom, top = raster.extent
    x = np.linspace(left, right, columns)[None, :]
    y = np.linspace(bottom, top, rows)[:, None]
    # About six pixels a stripe: what the eye can follow; real lamellae are far thinner.
    spacing = 6.0 * (right - left) / columns
    across = -np.sin(raster.lamella_angle) * x + np.cos(raster.lamella_angle) * y
    stripes = 0.5 + 0.5 * np.cos(2.0 * np.pi * across / spacing)
    # Knuth's multiplicative hash, so that neighbours in number get different tints.
    tint = _TINTS[(tint_by * 2654435761 >> 7) % len(_TINTS)]
    return np.asarray(tint * (1.0 - hatch * stripes)[..., None])


def show_raster(
    axes: Any,
    raster: LabelRaster,
    tint_by: IntArray,
    borders: Sequence[IntArray] = (),
    hatch: float = 0.18,
) -> None:
    """Put the hatched picture with dark borders between labels into the axes."""
    picture = hatched(raster, tint_by, hatch)
    for labels in borders:
        picture[_edges(labels)] *= 0.45
    axes.imshow(picture, extent=raster.extent, origin="lower", interpolation="antialiased")
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    _frame(axes)


def _edges(labels: IntArray) -> BoolArray:
    edge = np.zeros(labels.shape, dtype=bool)
    edge[:, 1:] |= labels[:, 1:] != labels[:, :-1]
    edge[1:, :] |= labels[1:, :] != labels[:-1, :]
    return edge


def is_legible(labels: IntArray) -> bool:
    """Return whether the labels (rows, columns) of a raster are more than borders."""
    return bool(_edges(labels).mean() < 0.3)


def _frame(axes: Any) -> None:
    for spine in axes.spines.values():
        spine.set_visible(True)


def draw_microstructure(path: Path, rasters: Mapping[str, LabelRaster]) -> None:
    """Draw prior austenite grains, blocks and colonies of each state, lamellae as hatching.

    Args:
        path: Without suffix.
        rasters: State -> labels of its window, or of a part of it where colonies are thin.
    """
    levels = ("prior_austenite_grain", "block", "colony")
    titles = ("prior austenite grains", "blocks", "colonies and lamellae")
    with drawing(path, WIDTH, 2.35 * len(rasters) + 0.3, pictures=True) as figure:
        grid = figure.subplots(len(rasters), 3, squeeze=False)
        for row, (state, raster) in zip(grid, rasters.items(), strict=True):
            for axes, level in zip(row, levels, strict=True):
                labels = getattr(raster, level)
                hatch = 0.35 if level == "colony" else 0.0
                show_raster(axes, raster, labels, [labels], hatch)
            left, right, _, _ = raster.extent
            row[0].set_ylabel(f"{state_label(state)}\n{right - left:.0f} µm wide")
        for axes, title in zip(grid[0], titles, strict=True):
            axes.set_title(title)


def draw_mesh(path: Path, meshes: Mapping[str, tuple[FloatArray, IntArray]]) -> None:
    """Draw the interfaces of meshes coloured by kind.

    Args:
        path: Without suffix.
        meshes: State -> (end points [um] (k, 2, 2), kind (k,)).
    """
    rows, columns = grid_shape(len(meshes))
    with drawing(path, WIDTH, 2.4 * rows + 0.35) as figure:
        grid = figure.subplots(rows, columns, squeeze=False)
        for axes in grid.flat[len(meshes) :]:
            axes.axis("off")
        for axes, (title, (segments, kind)) in zip(grid.flat, meshes.items(), strict=False):
            show_kinds(axes, segments, kind)
            axes.set(title=state_label(title), xticks=[], yticks=[])
        handles = _kind_handles()
        legend_below(figure, handles, len(handles))


def show_kinds(axes: Any, segments: FloatArray, kind: IntArray, width: float = 0.35) -> None:
    """Put the interfaces of a mesh into the axes, coloured by kind.

    Args:
        axes: Where to draw.
        segments: End points [um]; (k, 2, 2).
        kind: Values of ``scene.Kind``; (k,).
        width: Of the lines [points].
    """
    for value, colour in KIND_COLOURS.items():
        own = 4.0 * width if value is Kind.NOTCH else width
        lines = list(segments[kind == value])
        axes.add_collection(LineCollection(lines, colors=colour, linewidths=own, rasterized=True))
    axes.autoscale_view()
    axes.margins(0.0)
    axes.set_aspect("equal")
    _frame(axes)


def show_mesh(axes: Any, segments: FloatArray, kind: IntArray) -> None:
    """Put one mesh with its scale and the legend of the kinds into the axes.

    Args:
        axes: Where to draw.
        segments: End points of the interfaces [um]; (k, 2, 2).
        kind: Values of ``scene.Kind``; (k,).
    """
    show_kinds(axes, segments, kind, width=0.6)
    axes.set(xlabel="x [µm]", ylabel="y [µm]")
    axes.legend(
        handles=_kind_handles(),
        loc="upper right",
        frameon=True,
        framealpha=0.9,
        fontsize=6.5,
        handlelength=1.0,
    )


def _kind_handles() -> list[Patch]:
    return [
        Patch(color=colour, label=kind.name.lower().replace("_", " "))
        for kind, colour in KIND_COLOURS.items()
    ]


def draw_lamella_angles(
    path: Path,
    angles: Mapping[str, FloatArray],
    distribution: Mapping[str, Callable[[FloatArray], FloatArray]],
) -> None:
    """Draw the share of colonies per lamella angle against the closed form, source figure 3.

    Args:
        path: Without suffix.
        angles: State -> lamella angles of the colonies in [0, pi) [rad].
        distribution: State -> distribution function of the angle, 0 at 0 and 1 at pi.
    """
    edges = np.linspace(0.0, np.pi, 37)
    styles = state_styles(list(angles))
    rows, columns = grid_shape(len(angles))
    with drawing(path, WIDTH, 2.2 * rows) as figure:
        grid = figure.subplots(rows, columns, sharex=True, squeeze=False)
        for axes in grid.flat[len(angles) :]:
            axes.axis("off")
        for axes, (state, values) in zip(grid.flat, angles.items(), strict=False):
            share = 100.0 * np.histogram(values, edges)[0] / max(len(values), 1)
            axes.stairs(share, np.degrees(edges), fill=True, color=styles[state].colour, alpha=0.5)
            expected = 100.0 * np.diff(distribution[state](edges))
            axes.stairs(expected, np.degrees(edges), color=INK, linewidth=1.0, label="closed form")
            axes.set(title=f"{styles[state].label}, {len(values)} colonies", xlim=(0.0, 180.0))
            axes.set_xticks([0, 45, 90, 135, 180])
            axes.grid(True, axis="y")
        grid[0, 0].legend(frameon=True, framealpha=0.9, edgecolor="none", loc="lower right")
        label_outer(grid, len(angles), "angle to the crack's direction [°]", "colonies [% per 5°]")


def draw_lamella_roses(path: Path, angles: Mapping[str, FloatArray]) -> None:
    """Draw the lamella angles of each state as a rose; area stands for the share of colonies.

    Args:
        path: Without suffix.
        angles: State -> lamella angles of the colonies in [0, pi) [rad].
    """
    edges = np.linspace(0.0, np.pi, 37)
    styles = state_styles(list(angles))
    rows, columns = grid_shape(len(angles), most=5)
    with drawing(path, WIDTH, 1.9 * rows, pictures=True) as figure:
        grid = figure.subplots(rows, columns, squeeze=False)
        for axes in grid.flat:
            axes.axis("off")
        for axes, (state, values) in zip(grid.flat, angles.items(), strict=False):
            radius = np.sqrt(np.histogram(values, edges)[0] / max(len(values), 1))
            rim = np.stack([np.cos(edges), np.sin(edges)], axis=1) * radius.max(initial=1e-9) * 1.05
            petals = np.zeros((len(radius), 3, 2))
            petals[:, 1], petals[:, 2] = rim[:-1], rim[1:]
            petals *= (radius / (radius.max(initial=1e-9) * 1.05))[:, None, None]
            axes.add_collection(
                PolyCollection(
                    [*petals, *-petals],
                    facecolors=styles[state].colour,
                    edgecolors="white",
                    linewidths=0.15,
                )
            )
            axes.plot(*np.concatenate([rim, -rim]).T, color=INK, linewidth=0.8)
            axes.set(aspect="equal", title=styles[state].label)
