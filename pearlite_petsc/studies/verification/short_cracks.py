"""Threshold of short cracks under the law ``critical_distance``: the Kitagawa-Takahashi diagram."""

from pathlib import Path

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.damage import crack_distance, rated_length
from pearlite_petsc.mechanics.lefm import TIP_FACTOR, edge_crack_factor
from pearlite_petsc.mechanics.loads import uniform_stress
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.mechanics.statics import solve_loads
from pearlite_petsc.output.figures.style import drawing, legend_below
from pearlite_petsc.studies.bodies import on_line, plain_mesh, tensor_points
from pearlite_petsc.studies.cases import STATES, STEEL
from pearlite_petsc.studies.verification.claim import Section, Setting

CRITICAL_DISTANCE = 30.0
DELTA_K_TH = STATES["undeformed"].delta_k_th
LIMIT = TIP_FACTOR * DELTA_K_TH / np.sqrt(CRITICAL_DISTANCE)
"""Fatigue limit of a body without a crack [MPa]."""

NOTCHES = (4.0, 16.0, 2.0, 8.0, 32.0, 64.0, 128.0, 200.0)
_AROUND, _RATIO, _COARSEST = 24.0, 1.25, 16.0


def short_cracks(setting: Setting) -> Section:
    """Return the claims about edge notches in a homogeneous body under a remote stress."""
    section = Section("Short cracks")
    notches = sorted(NOTCHES[: setting.pick(2, 6, 8)])
    found = [threshold_stress(length, 2.0) for length in notches]
    for length, stress in zip(notches, found, strict=True):
        expected = el_haddad(length)
        section.close(
            f"Notch of {length:g} um, l_0 = {CRITICAL_DISTANCE:g} um: threshold stress over El "
            "Haddad's",
            "Delta-K_th/(F sqrt(pi (a + a_0)))",
            1.0,
            stress / expected,
            0.1,
        )
    widths = {width: threshold_stress(4.0, width) for width in (1.0, 4.0)}
    for width, stress in widths.items():
        section.close(
            f"Notch of 4 um in elements of {width:g} um: threshold stress over that of 2 um",
            "a length that is not the element's",
            1.0,
            stress / found[notches.index(4.0)],
            0.05,
        )
    section.text.append(
        f"Law `critical_distance`, Delta-K_th = {DELTA_K_TH / 1e3:g} MPa sqrt(m): the smallest remote "
        "stress range under which any interface takes damage. Without a notch it is the fatigue "
        f"limit, {LIMIT:.0f} MPa, at every element size, because l is l_0 there; `objective` would "
        "put b Delta-K_th/sqrt(L) in its place. El Haddad's a_0 is l_0/(2 F^2)."
    )
    rows = [
        [f"{length:g}", f"{stress:.0f}", f"{el_haddad(length):.0f}", f"{long_crack(length):.0f}"]
        for length, stress in zip(notches, found, strict=True)
    ]
    section.table(["notch um", "threshold MPa", "El Haddad MPa", "long crack MPa"], rows)
    _draw(setting.folder / "short_cracks", notches, found)
    section.figures["short_cracks"] = (
        "Threshold stress over the length of an edge notch (Kitagawa-Takahashi): elements of 2 um "
        "under `critical_distance`, El Haddad, and the limits of a long crack and of no crack."
    )
    return section


def long_crack(length: float) -> float:
    """Return Delta-K_th/(F sqrt(pi a)) of an edge notch [MPa]."""
    factor = edge_crack_factor(length / body_width(length))
    return float(DELTA_K_TH / (factor * np.sqrt(np.pi * length)))


def el_haddad(length: float) -> float:
    """Return Delta-K_th/(F sqrt(pi (a + a_0))), a_0 such that a = 0 is the fatigue limit [MPa]."""
    factor = edge_crack_factor(length / body_width(length))
    intrinsic = CRITICAL_DISTANCE / (2.0 * factor**2)
    return float(DELTA_K_TH / (factor * np.sqrt(np.pi * (length + intrinsic))))


def body_width(length: float) -> float:
    """Return the width of the body of a notch [um]."""
    return float(_edges(length + _AROUND, 2.0, 8.0 * max(length, 30.0))[-1])


def threshold_stress(length: float, width: float) -> float:
    """Return the least remote stress range that damages an interface near an edge notch [MPa].

    Args:
        length: Of the notch [um], a multiple of ``width``.
        width: Of the square elements round it [um].
    """
    x = _edges(length + _AROUND, width, body_width(length))
    up = _edges(_AROUND, width, 8.0 * max(length, 30.0))
    y = np.concatenate([-up[:0:-1], up]) + up[-1]
    mesh = plain_mesh(tensor_points(x, y), x[-1], y[-1])
    notch = on_line(mesh, up[-1], 0.0, length)
    load = uniform_stress(0.0, 1.0, 0.0)
    (solution,) = solve_loads(mesh, spring_stiffness(mesh, STEEL), notch, [load])
    # Coarse elements take no damage.
    near = (mesh.length < 1.01 * width) & ~notch
    near &= np.abs(mesh.midpoint - [0.5 * length, up[-1]]).max(axis=1) < 0.5 * length + _AROUND
    ends = mesh.vertices[mesh.interface_vertices[notch]]
    distance = crack_distance(mesh.midpoint[near], ends)
    rated = rated_length(mesh.length[near], distance, CRITICAL_DISTANCE)
    stress = np.maximum(solution.traction[near, 0], np.abs(solution.traction[near, 1]))
    return float((TIP_FACTOR * DELTA_K_TH / np.sqrt(rated) / np.maximum(stress, 1e-9)).min())


def _edges(fine: float, width: float, far: float) -> FloatArray:
    """Return edges of cells, of one width up to ``fine`` and growing until ``far`` [um]."""
    edges = np.arange(round(fine / width) + 1) * width
    step, last = width, edges[-1]
    grown = []
    while last < far:
        step = min(step * _RATIO, _COARSEST * width)
        last += step
        grown.append(last)
    return np.concatenate([edges, grown])


def _draw(path: Path, notches: list[float], found: list[float]) -> None:
    with drawing(path, height=3.4) as figure:
        axes = figure.subplots()
        line = np.geomspace(1.0, 300.0, 80)
        axes.plot(line, [el_haddad(length) for length in line], label="El Haddad")
        axes.plot(line, [long_crack(length) for length in line], "--", label="long crack")
        axes.axhline(LIMIT, linestyle=":", color="#1a1a1a", label="no crack")
        axes.plot(notches, found, "o", color="#1a1a1a", label="elements of 2 um")
        axes.set(xscale="log", yscale="log", xlabel="notch [um]", ylabel="threshold stress [MPa]")
        axes.set_ylim(0.5 * min(found), 2.0 * LIMIT)
        legend_below(figure, axes.get_legend_handles_labels()[0], 4)
