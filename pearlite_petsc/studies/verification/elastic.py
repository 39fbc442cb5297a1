"""Elastic constants that meshes of all states show under all spring laws, before any damage."""

from pearlite_petsc.errors import PearliteError
from pearlite_petsc.mechanics.elasticity import Certificate, certificate, ratio_of_mesh
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.scene import Shear
from pearlite_petsc.studies.bodies import plain_mesh, random_points
from pearlite_petsc.studies.cases import STATES, STEEL, scene_of, steel
from pearlite_petsc.studies.verification.claim import Section, Setting
from pearlite_petsc.tessellation.build import build_mesh
from pearlite_petsc.tessellation.mesh import Mesh

LAWS: tuple[str, ...] = ("homogeneous", "matched", "raje")
SHEARS: tuple[Shear, ...] = ("remesh", "affine")


def elastic(setting: Setting) -> Section:
    """Return the claims about elastic constants and the table of certificates."""
    section = Section("Elastic certificate of the meshes")
    size = float(setting.pick(60, 100, 160))
    found: dict[tuple[str, str, Shear], Certificate | str] = {}
    for shear in SHEARS:
        for name, state in STATES.items():
            mesh = build_mesh(scene_of((size, size, 0.4 * size), shear=shear), state, 0)
            for springs in LAWS:
                found[name, springs, shear] = certificate_or_reason(mesh, springs)
    for name in STATES:
        _homogeneous(section, name, found[name, "homogeneous", "remesh"])
        _matched(section, name, found[name, "matched", "remesh"])
    raje = found["undeformed", "raje", "remesh"]
    sheared = found["severe_AT", "raje", "affine"]
    if isinstance(raje, Certificate) and isinstance(sheared, Certificate):
        _limits(section, raje, sheared)
    _random(section)
    section.text.append(
        f"Meshes of {size:g} x {size:g} um, elements 2 x 4 um. Constants of the linear field closest "
        "to the elements' displacements under tension along x, along y and pure shear; wanted: "
        "E = 1, nu = 0.3 (homogeneous: 0), G = 0.385 (0.5), no coupling. Stress error: rms error of "
        "the normal traction over the applied stress."
    )
    section.table(
        [
            "mesh",
            "state",
            "springs",
            "E_x/E",
            "E_y/E",
            "nu_xy",
            "nu_yx",
            "G/E",
            "coupling",
            "stress error",
        ],
        [[key[2], key[0], key[1], *_row(value)] for key, value in found.items()],
    )
    return section


def _homogeneous(section: Section, name: str, found: Certificate | str) -> None:
    law = "springs E/L_eq on a Voronoi mesh"
    label = f"{name}, homogeneous, remesh"
    if isinstance(found, str):
        section.true(f"{label}: has elastic constants", law, "constants", found, False)
        return
    for axis, modulus in (("x", found.e_x), ("y", found.e_y)):
        section.close(f"{label}: E_{axis}/E", law, 1.0, _share(modulus), 1e-4)
    worst = max(abs(found.nu_xy), abs(found.nu_yx), found.coupling)
    section.below(f"{label}: nu and normal-shear coupling", law, worst, 1e-4)
    section.close(f"{label}: 2 G/E", "nu = 0", 1.0, 2.0 * _share(found.g), 1e-4)


def _matched(section: Section, name: str, found: Certificate | str) -> None:
    label = f"{name}, matched, remesh"
    if STATES[name].shear_strain > 10.0:
        section.true(
            f"{label}: rows of parallel cells do not reach nu = 0.3, refused by name",
            "known limit",
            "refused",
            found if isinstance(found, str) else "accepted",
            isinstance(found, str),
        )
        return
    if isinstance(found, str):
        section.true(f"{label}: reaches nu", "k_t/k_n per mesh", "nu = 0.3", found, False)
        return
    nu = 0.5 * (found.nu_xy + found.nu_yx)
    section.close(f"{label}: mean of nu_xy and nu_yx", "k_t/k_n per mesh", 0.3, nu, 1e-4)
    mean = 0.5 * _share(found.e_x + found.e_y)
    section.close(f"{label}: mean of E_x/E and E_y/E", "E = E_n (1 - nu)", 1.0, mean, 0.01)


def _limits(section: Section, raje: Certificate, sheared: Certificate) -> None:
    law = "known limit of Eq. (24)-(25)"
    section.above("raje on a Voronoi mesh misses E: 1 - E_y/E", law, 1.0 - _share(raje.e_y), 0.2)
    section.above("raje on a Voronoi mesh misses nu: nu - 0.3", law, raje.nu_yx - 0.3, 0.15)
    section.above(
        "raje on a Voronoi mesh: rms error of the normal traction over the stress",
        law,
        raje.stress_error,
        0.3,
    )
    section.above(
        "Affine shear to gamma = 30 (A-T), raje: E_x/E_y before any damage",
        "known limit of shearing the vertices by F",
        sheared.e_x / sheared.e_y,
        10.0,
    )


def certificate_or_reason(mesh: Mesh, springs: str) -> Certificate | str:
    """Return the elastic constants of a mesh, or why it has none with these springs."""
    try:
        material = steel(springs)
        stiffness = spring_stiffness(mesh, material, ratio_of_mesh(mesh, material))
        return certificate(mesh, stiffness)
    except PearliteError as error:
        return str(error)


def _random(section: Section) -> None:
    mesh = plain_mesh(random_points(900, 30.0, 30.0, seed=3), 30.0, 30.0)
    found = certificate(mesh, spring_stiffness(mesh, STEEL))
    worst = max(abs(_share(found.e_x) - 1.0), abs(_share(found.e_y) - 1.0), abs(found.nu_xy))
    section.below(
        "Random nuclei (slivers and all), homogeneous: E_x/E - 1, E_y/E - 1, nu",
        "E/L_eq on a Voronoi mesh",
        worst,
        1e-9,
    )


def _share(modulus: float) -> float:
    return modulus / STEEL.youngs_modulus


def _row(found: Certificate | str) -> list[str]:
    if isinstance(found, str):
        return [f"refused: {found}", *[""] * 6]
    values = (_share(found.e_x), _share(found.e_y), found.nu_xy, found.nu_yx, _share(found.g))
    return [f"{value:.3g}" for value in (*values, found.coupling, found.stress_error)]
