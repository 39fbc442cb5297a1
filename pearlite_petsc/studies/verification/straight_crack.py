"""A straight crack in one colony: da/dN of both damage laws over the element size."""

from dataclasses import replace

import numpy as np

from pearlite_petsc.fatigue.damage import OBJECTIVE, PRINTED, straight_crack_factor
from pearlite_petsc.growth.prepared import Prepared, prepare_growth
from pearlite_petsc.mechanics.lefm import TIP_FACTOR
from pearlite_petsc.scene import Kind, Scene, Solver
from pearlite_petsc.studies.bodies import on_line, plain_mesh, tensor_points
from pearlite_petsc.studies.cases import STATES, scene_of
from pearlite_petsc.studies.growing import grow_alone
from pearlite_petsc.studies.verification.claim import Section, fitted_order

DELTA_K = 2e4
STATE = replace(STATES["severe_AT"], delta_k_th=0.0)
"""One colony with lamellae along the crack: nothing but the law decides the rate."""

LAWS = (OBJECTIVE, PRINTED)

_TOLERANCES = {0.0: 0.015, 0.5: 0.07, 0.8: 0.15}
"""Of f by Delta-K_th/Delta-K, relative: the nearer the threshold, the more the width counts."""

SIZE, NOTCH, EXTENSION = 144.0, 60.0, 36.0
"""Square window, its notch, and the growth [um]: multiples of all widths in question."""


def grid_prepared(scene: Scene, width: float) -> Prepared:
    """Return square cells with lamellae along x and the notch on a line of facets."""
    edges = np.linspace(0.0, SIZE, round(SIZE / width) + 1)
    mesh = plain_mesh(tensor_points(edges, edges), SIZE, SIZE)
    along = np.abs(mesh.normal[:, 1]) > 0.5
    kind = np.where(along, int(Kind.LAMELLA), int(Kind.CEMENTITE))
    kind[on_line(mesh, 0.5 * SIZE, 0.0, NOTCH)] = int(Kind.NOTCH)
    across = (~along).astype(np.float64)
    mesh = replace(mesh, kind=kind, cementite_share=across, notch=(NOTCH, 0.5 * SIZE))
    # A uniform mesh is never replaced: what it was made from is not asked for.
    return replace(prepare_growth(scene, STATE, 0), mesh=mesh)


def straight_crack(section: Section, widths: tuple[float, ...]) -> None:
    """Add the claims about a straight crack at several element widths [um]."""
    scene = scene_of((SIZE, SIZE, NOTCH), (6.0, 6.0), extension=EXTENSION)
    # Small blocks: the law is in question here, not the jump.
    jump = replace(scene.cycle_jump, delta_d=0.25)
    scene = replace(scene, solver=Solver("iterative", 1e-7, 5000), cycle_jump=jump)
    rates: dict[str, list[float]] = {law.name: [] for law in LAWS}
    for width in widths:
        square = replace(scene, elements=replace(scene.elements, width=width, length=width))
        prepared = grid_prepared(scene, width)
        for law in LAWS:
            damage = replace(scene.damage, law=law)
            rates[law.name].append(
                grow_alone(replace(square, damage=damage), STATE, DELTA_K, prepared).da_dn
            )
    objective = np.array(rates["objective"])
    for width, rate in zip(widths[1:], objective[1:], strict=True):
        section.close(
            f"Straight crack in one colony, objective: da/dN at {width:g} um over that at "
            f"{widths[0]:g} um",
            "objective law: da/dN does not depend on L",
            1.0,
            float(rate / objective[0]),
            0.1,
        )
    section.close(
        "Straight crack in one colony, printed: power of the element size that da/dN follows",
        "Eq. (28)-(31) with a stress b K/sqrt(L)",
        -1.5,
        fitted_order(list(widths), rates["printed"]),
        0.1,
    )
    factor = (TIP_FACTOR / np.sqrt(scene.damage.reference_length)) ** 3
    alone = scene.damage.c / STATE.yield_stress * factor * DELTA_K**3
    section.text.append(
        "A straight crack in one colony (square cells, lamellae along it, no threshold): da/dN "
        "over (C/S)(b/sqrt(l_ref))^3 Delta-K^3 is "
        + ", ".join(
            f"{rate / alone:.2f} at {width:g} um"
            for width, rate in zip(widths, objective, strict=True)
        )
        + " with the law `objective`: what is left of a damaged interface bears more, and interfaces "
        "further ahead are damaged before the tip arrives."
    )
    _factors(section, scene, widths[0])


def _factors(section: Section, scene: Scene, width: float) -> None:
    """Add the claims about f of the formula with a threshold."""
    square = replace(scene, elements=replace(scene.elements, width=width, length=width))
    prepared = grid_prepared(square, width)
    scale = scene.damage.c / STATE.yield_stress
    scale *= (TIP_FACTOR / np.sqrt(scene.damage.reference_length)) ** 3
    for ratio, tolerance in _TOLERANCES.items():
        state = replace(STATE, delta_k_th=ratio * DELTA_K)
        rate = grow_alone(square, state, DELTA_K, prepared).da_dn
        expected = float(straight_crack_factor(np.array(ratio)))
        section.close(
            f"Straight crack at Delta-K_th/Delta-K = {ratio:g}, {width:g} um: f of "
            "f (C/S)(b/sqrt(l_ref))^3 (Delta-K - Delta-K_th)^3",
            'theory, "The length"',
            expected,
            rate / (scale * (DELTA_K - state.delta_k_th) ** 3),
            tolerance * expected,
        )
