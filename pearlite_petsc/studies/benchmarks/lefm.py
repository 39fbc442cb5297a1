"""K of an edge crack against time: rigid elements with each spring law, and finite elements."""

import argparse
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from time import process_time
from typing import Any, Literal

import numpy as np

from pearlite_petsc.mechanics.lefm import edge_crack_factor
from pearlite_petsc.studies.table import say, write_rows

WIDTHS = (8.0, 4.0, 2.0, 1.0)
LAWS: tuple[str, ...] = ("homogeneous", "matched", "raje")
MESHES = 4
"""Own meshes a width: their errors differ, and one may be right by chance."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``bench lefm``."""
    parser.add_argument("--quick", action="store_true", help="two coarse widths")


def main(args: argparse.Namespace) -> int:
    """Measure, write ``lefm.csv`` and the figure."""
    rows: list[dict[str, Any]] = []
    for _, measure in methods(WIDTHS[0]):
        with suppress(ImportError):
            measure()  # loads the libraries
    for width in WIDTHS[: 2 if args.quick else 4]:
        for series, measure in methods(width):
            started = process_time()
            try:
                unknowns, ratios = measure()
            except ImportError:
                say(f"{series}: scikit-fem is not installed")
                continue
            seconds = (process_time() - started) / len(ratios)
            error = float(np.sqrt(np.mean((np.array(ratios) - 1.0) ** 2)))
            say(
                f"{series:28} {width:4g} um  {unknowns:7d}  {seconds:7.2f} s  "
                f"K {np.mean(ratios):.4f}  rms error {error:.2%}"
            )
            rows.append(
                {
                    "series": series,
                    "width_um": width,
                    "unknowns": unknowns,
                    "seconds": seconds,
                    "bodies": len(ratios),
                    "k_over_exact": float(np.mean(ratios)),
                    "rms_error": error,
                }
            )
    write_rows(args.output / "lefm.csv", rows)
    draw(args.output / "lefm", rows)
    return 0


def methods(width: float) -> Iterator[tuple[str, Callable[[], tuple[int, list[float]]]]]:
    """Yield each method's name and what returns its unknowns and K over the accurate value."""
    yield "homogeneous, square cells", partial(square_cells, width)
    for springs in LAWS:
        yield f"{springs}, lamella-aligned", partial(own_mesh, width, springs)
    yield "finite elements, linear", partial(finite_elements, width, 1)
    yield "finite elements, quadratic", partial(finite_elements, width, 2)


def square_cells(width: float) -> tuple[int, list[float]]:
    """Return unknowns and K over Kaya and Erdogan's on a grid of square cells."""
    # Here and below, so that --help starts neither MPI nor PETSc.
    from pearlite_petsc.studies.cracked_bodies import EDGE, grid_ratios

    unknowns, ratios = grid_ratios(EDGE[1:2], width)
    return unknowns, [EDGE[1].over_reference(ratios[0])]


def own_mesh(width: float, springs: str) -> tuple[int, list[float]]:
    """Return unknowns and K over the accurate one on some of the program's own graded meshes."""
    from pearlite_petsc.studies.cracked_bodies import EDGE
    from pearlite_petsc.studies.own_meshes import release_ratio, strip_mesh

    meshes = [strip_mesh(width, index) for index in range(MESHES)]
    tada = edge_crack_factor(EDGE[1].ratio)
    correction = tada / (EDGE[1].reference or tada)
    unknowns = round(float(np.mean([3 * mesh.element_count for mesh in meshes])))
    return unknowns, [release_ratio(mesh, springs) * correction for mesh in meshes]


def finite_elements(width: float, order: Literal[1, 2]) -> tuple[int, list[float]]:
    """Return unknowns and K over the accurate one on triangles.

    Raises:
        ImportError: scikit-fem is not installed.
    """
    from pearlite_petsc.studies.cracked_bodies import EDGE
    from pearlite_petsc.studies.finite_elements import finite_element_ratio

    unknowns, ratio = finite_element_ratio(EDGE[1], width, order)
    return unknowns, [EDGE[1].over_reference(ratio)]


def draw(path: Path, rows: list[dict[str, Any]]) -> None:
    """Draw the error of K over time with the Pareto front."""
    from pearlite_petsc.output.figures.charts import Setting, draw_pareto

    settings = [
        Setting(
            f"{row['width_um']:g} um",
            row["series"],
            row["seconds"],
            row["rms_error"],
            row["series"] == "homogeneous, lamella-aligned" and row["width_um"] == 2.0,
        )
        for row in rows
    ]
    draw_pareto(path, settings, "time on one core, mesh included [s]", "rms error of K")
