"""K of an edge crack against time: rigid elements with each spring law, and finite elements."""

import argparse
import itertools
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from time import process_time
from typing import Any, Literal

import numpy as np

from pearlite_petsc.mechanics.lefm import edge_crack_factor
from pearlite_petsc.scene import Springs
from pearlite_petsc.studies.benchmarks.table import say, write_rows

WIDTHS = (8.0, 4.0, 2.0, 1.0)
LAWS: tuple[Springs, ...] = ("homogeneous", "matched", "raje")
MESHES = 4
"""Own meshes a width: their errors differ, and one may be right by chance."""

Order = Literal[1, 2]


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
    from pearlite_petsc.studies.verification.cracked_bodies import EDGE, grid_ratios

    unknowns, ratios = grid_ratios(EDGE[1:2], width)
    return unknowns, [EDGE[1].over_reference(ratios[0])]


def own_mesh(width: float, springs: Springs) -> tuple[int, list[float]]:
    """Return unknowns and K over the accurate one on some of the program's own graded meshes."""
    from pearlite_petsc.studies.verification.cracked_bodies import EDGE
    from pearlite_petsc.studies.verification.own_meshes import release_ratio, strip_mesh

    meshes = [strip_mesh(width, index) for index in range(MESHES)]
    tada = edge_crack_factor(EDGE[1].ratio)
    correction = tada / (EDGE[1].reference or tada)
    unknowns = round(float(np.mean([3 * mesh.element_count for mesh in meshes])))
    return unknowns, [release_ratio(mesh, springs) * correction for mesh in meshes]


def finite_elements(width: float, order: Order) -> tuple[int, list[float]]:
    """Return unknowns of half the body and K over the accurate one on triangles.

    Raises:
        ImportError: scikit-fem is not installed.
    """
    from skfem import MeshTri

    from pearlite_petsc.studies.verification.cracked_bodies import BASE, EDGE, layers

    body = EDGE[1]
    keys = (0.0, body.before, body.after, body.width)
    runs = [
        np.linspace(start, end, max(1, round((end - start) / width)) + 1)[:-1]
        for start, end in itertools.pairwise(keys)
    ]
    mesh = MeshTri.init_tensor(
        np.concatenate([*runs, [body.width]]), layers(round(13 * BASE / width))
    )
    unknowns, energies = _energies(mesh, order, (body.before, body.after))
    release = energies[1] - energies[0]
    return unknowns, [body.over_reference(float(np.sqrt(release / body.handbook_release())))]


def _energies(mesh: Any, order: Order, cracks: tuple[float, ...]) -> tuple[int, list[float]]:
    """Return the energy of the whole body under unit stress for each crack length [uN um].

    The upper half is solved; the ligament at y = 0 is held along y.
    """
    from scipy.sparse.linalg import splu
    from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, FacetBasis, LinearForm, asm
    from skfem.models.elasticity import linear_elasticity

    from pearlite_petsc.studies.cases import STEEL

    modulus, nu = STEEL.youngs_modulus, STEEL.poisson_ratio
    element = ElementVector(ElementTriP1() if order == 1 else ElementTriP2())
    basis = Basis(mesh, element)
    plane_stress = modulus * nu / (1.0 - nu**2), modulus / (2.0 * (1.0 + nu))
    matrix = asm(linear_elasticity(*plane_stress), basis).tocsc()
    top = mesh.facets_satisfying(lambda p: p[1] == mesh.p[1].max())
    load = asm(LinearForm(lambda v, w: v[1]), FacetBasis(mesh, element, facets=top))
    corner = np.argmax(mesh.p[0] - mesh.p[1])
    energies = []
    for length in cracks:
        # A facet's midpoint lies off its ends: only facets ahead of the tip are found.
        ahead = mesh.facets_satisfying(
            lambda p, length=length: (p[1] == 0.0) & (p[0] > length), boundaries_only=True
        )
        vertical = basis.get_dofs(ahead).all(["u^2"])
        held = np.append(vertical, basis.nodal_dofs[0, corner])
        free = np.setdiff1d(np.arange(len(load)), held)
        factor = splu(
            matrix[free][:, free], permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
        )
        energies.append(float(load[free] @ factor.solve(load[free])))
    return len(load), energies


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
