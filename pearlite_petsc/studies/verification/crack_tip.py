"""K_I, K_II and T measured at the tip: far field, slanted and kinked cracks."""

import numpy as np

from pearlite_petsc.mechanics.lefm import centre_crack_factor
from pearlite_petsc.mechanics.loads import uniform_stress, williams_mode_one
from pearlite_petsc.mechanics.tip_fields import TipFields, fit_tip_fields
from pearlite_petsc.output.figures.style import drawing
from pearlite_petsc.studies.cases import STEEL
from pearlite_petsc.studies.crack_tips import displacements, kinked_body, straight_body
from pearlite_petsc.studies.verification.claim import Section, Setting

K = 18e3
HALF = 40.0
WIDTH, HEIGHT = 800.0, 1600.0
WINDOW = 400.0

COTTERELL = "Cotterell and Rice 1980"
"""First order in the angle; doi 10.1007/BF00012619."""


def crack_tip(setting: Setting) -> Section:
    """Return the claims about K as it is measured on the elements' displacements."""
    section = Section("Stress intensity at the tip, measured on the elements")
    _rings(section, setting)
    _slanted(section, setting)
    _kinked(section, setting)
    return section


def far_field(angle: float, cell: float, kink: float, centred: str) -> TipFields:
    """Return what a kinked crack gets of a far field of K centred on its tip or the notch's line.

    Args:
        angle: Of the kink [rad].
        cell: Spacing of the nuclei round it [um].
        kink: Its length [um].
        centred: "tip", or "notch": at the tip's x on the line of the crack before the kink.
    """
    mesh, broken, tip = kinked_body(angle, kink, cell, WINDOW)
    centre = tip if centred == "tip" else (tip[0], 0.5 * WINDOW)
    (moved,) = displacements(mesh, broken, [williams_mode_one(K, centre)])
    ring = 3.0 * cell, 0.6 * kink
    return fit_tip_fields(mesh.centre, moved, tip, angle, *ring, STEEL.youngs_modulus, 0.0)


def _rings(section: Section, setting: Setting) -> None:
    """Claim that neither the ring nor the elements decide what is measured."""
    mesh, broken, tip = kinked_body(0.0, 20.0, 1.0, WINDOW)
    (moved,) = displacements(mesh, broken, [williams_mode_one(K, tip)])
    found = [
        fit_tip_fields(mesh.centre, moved, tip, 0.0, inner, outer, STEEL.youngs_modulus, 0.0).k_1
        for inner, outer in ((2.0, 6.0), (3.0, 10.0), (4.0, 16.0))
    ]
    spread = (max(found) - min(found)) / K
    section.close(
        "K_I of a straight crack under k_field over the K asked for",
        "Williams 1957",
        1.0,
        found[1] / K,
        0.005,
    )
    section.below("Spread of K_I over rings of 6, 10, 16 um", "path independence", spread, 2e-3)
    cells = [far_field(0.0, cell, 20.0, "tip").k_1 / K for cell in (2.0, 1.0)]
    section.below("Change of K_I from cells of 2 um to 1 um", "-", abs(cells[0] - cells[1]), 5e-3)


def _slanted(section: Section, setting: Setting) -> None:
    mesh, broken = straight_body(HALF, 1.0, WIDTH, HEIGHT)
    slants = np.deg2rad([15.0, 30.0, 45.0, 60.0])
    # The crack stays on the grid and the tension turns.
    loads = [
        uniform_stress(sin**2, cos**2, sin * cos)
        for sin, cos in zip(np.sin(slants), np.cos(slants), strict=True)
    ]
    tip = 0.5 * WIDTH + HALF, 0.5 * HEIGHT
    whole = centre_crack_factor(2.0 * HALF / WIDTH) * np.sqrt(np.pi * HALF)
    rows = []
    for slant, moved in zip(slants, displacements(mesh, broken, loads), strict=True):
        ring = 3.0, 0.25 * HALF
        found = fit_tip_fields(mesh.centre, moved, tip, 0.0, *ring, STEEL.youngs_modulus, 0.0)
        cos, sin = float(np.cos(slant)), float(np.sin(slant))
        name = f"slanted crack, {np.rad2deg(slant):.0f} degrees"
        one, two = found.k_1 / (cos**2 * whole), found.k_2 / (sin * cos * whole)
        section.close(f"K_I of a {name}, over sigma cos^2", "Tada; Sih", 1.0, one, 0.01)
        section.close(f"K_II of a {name}, over sigma sin cos", "Tada; Sih", 1.0, two, 0.01)
        t_stress = round(sin**2 - cos**2, 12)
        section.close(f"T of a {name}, over sigma", "Williams 1957", t_stress, found.t_stress, 0.03)
        rows.append([f"{np.rad2deg(slant):.0f}", f"{one:.4f}", f"{two:.4f}", f"{found.misfit:.1e}"])
    section.text.append(
        f"A plate of {WIDTH:g} x {HEIGHT:g} um with a centre crack of {2.0 * HALF:g} um under "
        "tension that is turned against it; cells of 1 um at the crack. K over the exact value:"
    )
    section.table(["angle [degrees]", "K_I", "K_II", "misfit"], rows)


def _kinked(section: Section, setting: Setting) -> None:
    angles = [15.0, 30.0] if setting.pick(0, 1) == 0 else [15.0, 30.0, 45.0, 60.0]
    cell, kinks = (1.0, [20.0]) if setting.pick(0, 1) == 0 else (0.5, [10.0, 20.0])
    rows, drawn = [], []
    for degrees in angles:
        angle = float(np.deg2rad(degrees))
        one, two = cotterell_rice(angle)
        for kink in kinks:
            tip, notch = (far_field(angle, cell, kink, place) for place in ("tip", "notch"))
            drawn.append((degrees, kink, tip, notch))
            rows.append(
                [
                    f"{degrees:g}",
                    f"{kink:g}",
                    *(f"{f.k_1 / K:.4f}, {f.k_2 / K:.4f}" for f in (tip, notch)),
                    f"{one:.4f}, {two:.4f}",
                ]
            )
            if degrees <= 30.0:
                name = f"kink of {degrees:g} degrees, {kink:g} um"
                section.close(f"K_I at a {name}", COTTERELL, 1.0, tip.k_1 / K / one, 0.01)
                section.close(f"K_II at a {name}", COTTERELL, 1.0, tip.k_2 / K / two, 0.01)
    section.text.append(
        f"A crack that kinks in a window of {WINDOW:g} um under the far field of K. Kinks are short "
        "against everything in the continuum's solution, so that K_I, K_II over K depend on the "
        "angle alone. With the far field centred on the tip they do here, too; centred at the "
        "tip's x on the line of the crack before the kink, the window makes itself felt, the more "
        "the longer the kink:"
    )
    section.table(
        ["angle [degrees]", "kink [um]", "far field on the tip", "on the notch's line", COTTERELL],
        rows,
    )
    _draw(section, setting, drawn)


def cotterell_rice(angle: float) -> tuple[float, float]:
    """Return K_I and K_II at a short kink over K_I of the crack before it, to first order."""
    half, three = 0.5 * angle, 1.5 * angle
    one = 0.25 * (3.0 * np.cos(half) + np.cos(three))
    two = 0.25 * (np.sin(half) + np.sin(three))
    return float(one), float(two)


def _draw(
    section: Section, setting: Setting, drawn: list[tuple[float, float, TipFields, TipFields]]
) -> None:
    turn = np.linspace(0.0, max(item[0] for item in drawn) + 5.0, 100)
    curves = np.array([cotterell_rice(angle) for angle in np.deg2rad(turn)])
    with drawing(setting.folder / "kinked_cracks", height=3.2) as figure:
        axes = figure.subplots()
        for column, name in ((0, "$K_I$"), (1, "$K_{II}$")):
            axes.plot(turn, curves[:, column], color=f"C{column}", label=f"{name}, first order")
        for marker, place, name in (("o", 2, "tip"), ("x", 3, "notch's line")):
            for column, mode in ((0, "k_1"), (1, "k_2")):
                axes.plot(
                    [item[0] for item in drawn],
                    [getattr(item[place], mode) / K for item in drawn],
                    marker,
                    color=f"C{column}",
                    fillstyle="none",
                    label=f"far field on the {name}" if column == 0 else None,
                )
        axes.set(xlabel="angle of the kink [degrees]", ylabel="K at the kink over K")
        axes.grid(True)
        axes.legend(loc="center left")
    section.figures["kinked_cracks"] = (
        "K at the tip of kinked cracks, measured on the elements, against the first-order solution "
        f"of {COTTERELL}; the far field centred on the tip, and at the tip's x on the line of the "
        "crack before the kink."
    )
