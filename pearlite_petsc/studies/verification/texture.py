"""The microstructure: sizes, nesting, directions of the lamellae, kinds of interfaces."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.microstructure.cells import equivalent_diameters, undeformed_cells
from pearlite_petsc.microstructure.labels import LabelMap, make_label_map
from pearlite_petsc.microstructure.shear import (
    orientation_order,
    preferred_angle,
    sheared_angle_cdf,
)
from pearlite_petsc.output.figures.style import drawing, state_styles
from pearlite_petsc.scene import Kind, Microstructure, Window
from pearlite_petsc.studies.cases import STATES, scene_of
from pearlite_petsc.studies.verification.claim import Section, Setting
from pearlite_petsc.tessellation.build import build_mesh
from pearlite_petsc.tessellation.quality import quality

SIZES = {"prior austenite grain": 60.0, "block": 30.0, "colony": 15.0}
KOLMOGOROV = 1.63
"""sqrt(n) D at the 1 % level of the Kolmogorov-Smirnov test."""


def texture(setting: Setting) -> Section:
    """Return the claims about the microstructure."""
    section = Section("Microstructure")
    window = Window(200.0, 200.0, 80.0)
    sizes = Microstructure(60.0, 30.0, 15.0, seed=1)
    count = setting.pick(4, 20)
    angles = {}
    for name, state in STATES.items():
        maps = [make_label_map(sizes, window, state, index) for index in range(count)]
        _sizes(section, name, maps[:4])
        angles[name] = np.concatenate([label_map.lamella_angle for label_map in maps])
        _nesting(section, name, maps[0])
        _angles(section, name, angles[name])
    _kinds(section)
    _draw(setting.folder / "lamella_angles", angles)
    section.figures["lamella_angles"] = (
        "Directions of the lamellae of all colonies after shear, and the closed form cot(theta) = "
        "cot(theta_0) + gamma for directions uniform before (figure 3 of the source). 90 degrees is "
        "along the load for A-T."
    )
    return section


def _sizes(section: Section, name: str, maps: list[LabelMap]) -> None:
    measured = [
        np.concatenate(level) for level in zip(*map(equivalent_diameters, maps), strict=True)
    ]
    for (level, target), values in zip(SIZES.items(), measured, strict=True):
        section.close(
            f"{name}: mean equivalent circle diameter of a {level}, four meshes, um",
            "target of the scene",
            target,
            float(values.mean()),
            0.05 * target,
        )


def _nesting(section: Section, name: str, label_map: LabelMap) -> None:
    areas = [cells.area() for cells in undeformed_cells(label_map)]
    worst = 0.0
    for level in (1, 2):
        parent = label_map.levels[level].parent
        total = np.bincount(parent, weights=areas[level], minlength=len(areas[level - 1]))
        worst = max(worst, float(np.max(np.abs(total / areas[level - 1] - 1.0))))
    section.below(
        f"{name}: children fill their parents: largest relative error of an area",
        "nested Voronoi tessellations",
        worst,
        1e-9,
    )


def _angles(section: Section, name: str, angle: FloatArray) -> None:
    state = STATES[name]
    section.below(
        f"{name}: sqrt(n) D of {len(angle)} lamella directions against the closed form",
        "cot(theta) = cot(theta_0) + gamma; Kolmogorov-Smirnov at 1 %",
        float(np.sqrt(len(angle)) * kolmogorov_distance(angle, name)),
        KOLMOGOROV,
    )
    mean = np.exp(2j * angle).mean()
    section.close(
        f"{name}: orientation order |mean exp(2 i theta)|",
        "gamma/sqrt(4 + gamma^2)",
        orientation_order(state.shear_strain),
        float(abs(mean)),
        4.0 / np.sqrt(len(angle)),
    )
    if state.shear_strain:
        preferred = preferred_angle(state.shear_strain, state.orientation)
        turn = 0.5 * float(np.angle(mean * np.exp(-2j * preferred)))
        section.close(
            f"{name}: preferred direction, degrees",
            "atan2(2, gamma)/2 from the shear's direction",
            float(np.degrees(preferred)),
            float(np.degrees(preferred + turn)),
            float(np.degrees(3.0 / np.sqrt(len(angle)))),
        )


def kolmogorov_distance(angle: FloatArray, name: str) -> float:
    """Return the largest distance of the empirical from the exact distribution function."""
    state = STATES[name]
    ordered = np.sort(angle)
    exact = sheared_angle_cdf(ordered, state.shear_strain, state.orientation)
    step = np.arange(len(ordered) + 1) / len(ordered)
    return float(max(np.max(step[1:] - exact), np.max(exact - step[:-1])))


def _kinds(section: Section) -> None:
    scene = scene_of((120.0, 120.0, 40.0), (2.0, 4.0))
    huge = replace(scene, microstructure=Microstructure(1e5, 1e5, 1e5, 1))
    mesh = build_mesh(huge, STATES["severe_AT"], 0)
    shares = quality(mesh, 40.0).kind_length_share
    section.close(
        "One colony: length of lamella over cementite interfaces is the elements' length over width",
        "lattice along the lamellae, 4 x 2 um",
        2.0,
        shares[Kind.LAMELLA] / shares[Kind.CEMENTITE],
        0.1,
    )
    rows = []
    for name, state in STATES.items():
        found = quality(build_mesh(scene, state, 0), 40.0)
        rows.append([name, *(f"{100.0 * share:.1f}" for share in found.kind_length_share.values())])
    section.text.append(
        "Share of each kind in the length of all interfaces but the notch's, %. At gamma = 30 a "
        "colony is 0.5 um thin, less than an element: neighbours along the shear belong to different "
        "grains, and `lamella` does not occur."
    )
    section.table(["state", *(kind.name.lower() for kind in Kind if kind != Kind.NOTCH)], rows)


def _draw(path: Path, angles: dict[str, FloatArray]) -> None:
    styles = state_styles(list(angles))
    with drawing(path, height=2.4) as figure:
        panels = figure.subplots(1, len(angles), sharey=True)
        bins = np.linspace(0.0, np.pi, 37)
        for axes, (name, angle) in zip(panels, angles.items(), strict=True):
            state, style = STATES[name], styles[name]
            share = np.histogram(angle, bins)[0] / len(angle)
            exact = np.diff(sheared_angle_cdf(bins, state.shear_strain, state.orientation))
            axes.stairs(100.0 * share, np.degrees(bins), fill=True, color=style.colour, alpha=0.4)
            axes.stairs(100.0 * exact, np.degrees(bins), color="#1a1a1a", linewidth=0.9)
            axes.set(title=style.label, xticks=[0, 90, 180], yscale="log", ylim=(0.01, 100.0))
        panels[len(panels) // 2].set_xlabel("direction of the lamellae [degrees]")
        panels[0].set_ylabel("share a 5 degrees [%]")
