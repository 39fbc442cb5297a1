"""What every spring law must fulfil."""

from dataclasses import fields, replace

import numpy as np

from pearlite_petsc.arrays import IntArray
from pearlite_petsc.laws.springs import SpringInterfaces
from pearlite_petsc.mechanics.elasticity import certificate, ratio_of_mesh
from pearlite_petsc.mechanics.springs import spring_stiffness, stiffness_of
from pearlite_petsc.scene import Kind, Material, Scene
from pearlite_petsc.studies.bodies import plain_mesh, random_points
from pearlite_petsc.studies.verification.claim import Section

COUNT = 200
RATIO = 0.7
"""k_t/k_n that a law is given which meets the Poisson ratio."""


def interfaces_of() -> SpringInterfaces:
    """Return random interfaces of all kinds, lengths from 0.01 to 30 um."""
    random = np.random.default_rng(7)
    angle = random.uniform(0.0, np.pi, COUNT)
    kinds = [int(kind) for kind in Kind if kind is not Kind.NOTCH]
    return SpringInterfaces(
        centre_distance=random.uniform(0.5, 20.0, COUNT),
        length=np.geomspace(0.01, 30.0, COUNT),
        kind=random.choice(kinds, COUNT),
        midpoint=random.uniform(0.0, 200.0, (COUNT, 2)),
        normal=np.stack([np.cos(angle), np.sin(angle)], axis=1),
    )


def spring_claims(section: Section, scene: Scene) -> None:
    """Add the claims about the spring law that a scene has chosen.

    Raises:
        PearliteError: The law fails, or returns what no interface can have.
    """
    material, interfaces = scene.material, interfaces_of()
    known = stiffness_of(interfaces, material, RATIO)
    section.true(
        f"Stiffness of {COUNT} interfaces: shape, finite, positive",
        "units: MPa/um",
        "all",
        "all",
        True,
    )
    order = np.random.default_rng(3).permutation(COUNT)
    local = all(
        np.array_equal(part.k_n, known.k_n[chosen]) and np.array_equal(part.k_t, known.k_t[chosen])
        for chosen in (np.arange(COUNT), order, order[:1])
        for part in [stiffness_of(_taken(interfaces, chosen), material, RATIO)]
    )
    section.true(
        "The same again, and interface by interface in any order",
        "springs of an interface are its own",
        "equal",
        "equal" if local else "not equal",
        local,
    )
    double = replace(material, youngs_modulus=2.0 * material.youngs_modulus)
    twice = stiffness_of(interfaces, double, RATIO)
    section.below(
        "Twice Young's modulus makes both stiffnesses twice as large, relative error",
        "linear elasticity",
        float(
            max(
                np.abs(twice.k_n / known.k_n - 2.0).max(), np.abs(twice.k_t / known.k_t - 2.0).max()
            )
        ),
        1e-12,
    )
    _mesh_claims(section, material)


def _taken(interfaces: SpringInterfaces, chosen: IntArray) -> SpringInterfaces:
    arrays = {entry.name: getattr(interfaces, entry.name)[chosen] for entry in fields(interfaces)}
    return replace(interfaces, **arrays)


def _mesh_claims(section: Section, material: Material) -> None:
    mesh = plain_mesh(random_points(300, 30.0, 30.0, seed=5), 30.0, 30.0)
    ratio = ratio_of_mesh(mesh, material)
    found = certificate(mesh, spring_stiffness(mesh, material, ratio))
    moduli = (found.e_x, found.e_y, found.g)
    shown = ", ".join(f"{value / material.youngs_modulus:.3g}" for value in moduli)
    section.true(
        "A Voronoi mesh with these springs carries load: E_x, E_y and G over E",
        "positive definite",
        "positive",
        shown,
        all(np.isfinite(value) and value > 0.0 for value in moduli),
    )
    section.text.append(
        f"On a Voronoi mesh: E_x/E = {found.e_x / material.youngs_modulus:.3f}, nu_xy = "
        f"{found.nu_xy:.3f} (the scene's {material.poisson_ratio:g}), stress error under uniform "
        f"load {found.stress_error:.1%}"
    )
