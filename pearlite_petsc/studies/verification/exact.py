"""What must hold to rounding: patch tests, rigid modes, frame invariance, balance, loads."""

from collections.abc import Mapping

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.mechanics.elasticity import solve_uniform
from pearlite_petsc.mechanics.kinematics import jumps, rigid_modes, rotation_length
from pearlite_petsc.mechanics.loads import AiryFunction, facet_forces, williams_mode_one
from pearlite_petsc.mechanics.springs import Stiffness, spring_stiffness
from pearlite_petsc.mechanics.statics import load_vector, operators, solve, stiffness_matrix
from pearlite_petsc.scene import Kind, Solver
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.subdomain import subdomain_of
from pearlite_petsc.studies.bodies import (
    hexagonal_points,
    plain_mesh,
    random_points,
    rotated,
    rotation,
)
from pearlite_petsc.studies.cases import STATES, STEEL, scene_of, steel
from pearlite_petsc.studies.verification.claim import Section, Setting
from pearlite_petsc.tessellation.build import build_mesh
from pearlite_petsc.tessellation.mesh import Mesh

LOADS = {"tension x": (1.0, 0.0, 0.0), "tension y": (0.0, 1.0, 0.0), "shear": (0.0, 0.0, 1.0)}
ANGLES = (0.3, 0.5 * np.pi, 2.5, 4.0)


def exact(setting: Setting) -> Section:
    """Return the claims that hold to rounding on every mesh."""
    section = Section("Exact: patch tests, rigid modes, frame, balance")
    own = build_mesh(scene_of(window=(80.0, 80.0, 32.0)), STATES["moderate_AT"], 0)
    lattice, width, height = hexagonal_points(16, 14)
    bodies = {
        "hexagonal": plain_mesh(lattice, width, height),
        "random Voronoi": plain_mesh(random_points(400, 20.0, 20.0, seed=7), 20.0, 20.0),
        "lamella-aligned Voronoi": plain_mesh(own.centre, *own.window),
    }
    _patches(section, bodies)
    section.below(
        "The program's own mesh (facets below 1e-3 of the spacing dropped), rms traction error",
        "the same",
        max(_rms(own, load) for load in LOADS.values()),
        2e-3,
    )
    _affine(section, bodies["hexagonal"])
    _rigid(section, bodies)
    _balance(section, own)
    return section


def _patches(section: Section, bodies: Mapping[str, Mesh]) -> None:
    for name, mesh in bodies.items():
        for load, error in traction_errors(mesh).items():
            section.below(
                f"Patch test, {load}, {name}: traction is the stress times the normal",
                "Irons and Razzaque 1972; springs E/L_eq",
                error,
                1e-9,
            )


def _affine(section: Section, hexagonal: Mesh) -> None:
    for springs in ("raje", "homogeneous"):
        motion, stress = affine_errors(hexagonal, springs)
        section.below(
            f"Affine patch, {springs}, hexagonal: unbalanced force inside",
            "Eq. (24)-(25)",
            motion,
            1e-12,
        )
        section.below(
            f"Affine patch, {springs}, hexagonal: mean stress is Hooke's "
            f"(nu {STEEL.poisson_ratio if springs == 'raje' else 0:g})",
            "Eq. (24)-(25)",
            stress,
            1e-12,
        )


def _rigid(section: Section, bodies: Mapping[str, Mesh]) -> None:
    for name, mesh in bodies.items():
        section.below(
            f"Rigid modes, {name}: |K r| / (|K| |r|)", "Eq. (1)-(18)", rigid_error(mesh), 1e-12
        )
    stiff, softest = kernel(bodies["hexagonal"])
    section.true(
        "An intact connected mesh has no other rigid mode",
        "Eq. (16)-(18)",
        "3 zero eigenvalues",
        f"{stiff} below 1e-10 of the largest, the next at {softest:.1e}",
        stiff == 3,
    )


def _balance(section: Section, own: Mesh) -> None:
    broken = own.kind == Kind.NOTCH
    section.below(
        "Whole problem turned by 0.3, pi/2, 2.5, 4 rad: change of tractions over the largest",
        "objectivity of Eq. (1)-(18)",
        frame_error(own, broken),
        1e-9,
    )
    for method, limit in (("iterative", 1e-8), ("direct", 1e-8), ("reference", 1e-10)):
        worst = balance_error(own, broken, method)
        section.below(
            f"{method} solver: unbalanced force (or moment over the spacing) of the worst element "
            "over the largest force",
            "Eq. (16)-(18)",
            worst,
            limit,
        )
    section.below(
        "Resultant force and moment of k_field over the largest facet's",
        "Williams 1957, Airy function",
        load_resultant(own),
        1e-10,
    )


def traction_errors(mesh: Mesh) -> dict[str, float]:
    """Return the largest traction error of homogeneous springs under each unit load."""
    _, tractions = solve_uniform(mesh, _springs(mesh, "homogeneous"), np.array([*LOADS.values()]))
    return {
        name: float(np.abs(found - _exact_traction(mesh, load)).max())
        for (name, load), found in zip(LOADS.items(), tractions, strict=True)
    }


def affine_errors(mesh: Mesh, springs: str) -> tuple[float, float]:
    """Return unbalanced force and error of the mean stress when all centres move affinely.

    On a hexagonal packing the elements inside are in balance, and the stress averaged over one of
    them is that of plane stress (nu of the material for ``raje``, 0 for ``homogeneous``).
    """
    nu = STEEL.poisson_ratio if springs == "raje" else 0.0
    strain = np.array([[3e-4, 1e-4], [1e-4, -2e-4]])
    modulus = STEEL.youngs_modulus
    stress = modulus / (1 + nu) * strain + modulus * nu / (1 - nu**2) * np.trace(strain) * np.eye(2)
    operator, constants = operators(mesh, _springs(mesh, springs))
    motion = np.column_stack([mesh.centre @ strain, np.zeros(mesh.element_count)])
    i, j = mesh.interface_elements.T
    local = constants * jumps(operator, motion[i], motion[j])
    force = local[:, :1] * mesh.normal + local[:, 1:2] * _tangent(mesh)
    total = np.zeros((mesh.element_count, 2))
    np.add.at(total, i, force)
    np.add.at(total, j, -force)
    inside = np.ones(mesh.element_count, dtype=np.bool_)
    inside[mesh.boundary_elements] = False
    rim = ~inside
    inside[i[rim[j]]] = inside[j[rim[i]]] = False
    arm = mesh.centre[j] - mesh.centre[i]
    moments = 0.5 * arm[:, :, None] * force[:, None, :]
    average = np.zeros((mesh.element_count, 2, 2))
    np.add.at(average, i, moments)
    np.add.at(average, j, moments)
    average /= mesh.area[:, None, None]
    scale = np.abs(force).max()
    return (
        float(np.abs(total[inside]).max() / scale),
        float(np.abs(average[inside] - stress).max() / np.abs(stress).max()),
    )


def rigid_error(mesh: Mesh) -> float:
    """Return the largest |K r|/(|K| |r|) over the three modes and two spring laws."""
    errors = []
    for springs in ("homogeneous", "raje"):
        operator, constants = operators(mesh, _springs(mesh, springs))
        matrix = stiffness_matrix(mesh, operator, constants)
        modes = rigid_modes(mesh.centre, rotation_length(mesh), mesh.centre.mean(axis=0))
        for mode in modes.reshape(-1, 3).T:
            norm = abs(matrix).sum(axis=1).max() * np.abs(mode).max()
            errors.append(float(np.abs(matrix @ mode).max() / norm))
    return max(errors)


def kernel(mesh: Mesh) -> tuple[int, float]:
    """Return the number of zero eigenvalues and the next one over the largest."""
    matrix = stiffness_matrix(mesh, *operators(mesh, _springs(mesh, "raje"))).toarray()
    values = np.linalg.eigvalsh(matrix)
    zero = int((np.abs(values) < 1e-10 * values[-1]).sum())
    return zero, float(values[zero] / values[-1])


def frame_error(mesh: Mesh, broken: BoolArray) -> float:
    """Return how much tractions change when mesh and load are turned, over the largest."""
    springs = _springs(mesh, "homogeneous")
    airy = williams_mode_one(2e4, mesh.notch)
    here = solve(mesh, springs, broken, airy).traction
    errors = []
    for angle in ANGLES:
        turned = rotated(mesh, angle)
        there = solve(turned, _springs(turned, "homogeneous"), broken, turned_load(airy, angle))
        errors.append(np.abs(there.traction - here).max() / np.abs(here).max())
    return float(max(errors))


def turned_load(airy: AiryFunction, angle: float) -> AiryFunction:
    """Return the stress function of a load turned about the origin by an angle [rad]."""
    turn = rotation(angle)

    def function(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        value, gradient = airy(points @ turn)
        return value, gradient @ turn.T

    return function


def balance_error(mesh: Mesh, broken: BoolArray, method: str) -> float:
    """Return the unbalanced force or moment of the worst element after a solve.

    Forces and moments are added up element by element from the tractions, without the matrix. What
    remains with the program's solvers is their grounding, whose resultant the supports take up; the
    reference solver holds one element instead.
    """
    stiffness = _springs(mesh, "homogeneous")
    airy = williams_mode_one(2e4, mesh.notch)
    length = rotation_length(mesh)
    load = load_vector(mesh, airy) * [1.0, 1.0, length]
    run = mesh.length * ~broken
    springs = np.stack([stiffness.k_n, stiffness.k_t], axis=1)
    if method == "reference":
        carried = solve(mesh, stiffness, broken, airy).force
    else:
        subdomain = subdomain_of(mesh, stiffness, 0, mesh.element_count)
        settings = Solver("iterative" if method == "iterative" else "direct", 1e-10, 1000)
        with Equilibrium(MPI.COMM_SELF, subdomain, broken.astype(float), settings) as equilibrium:
            jump = equilibrium.jumps(equilibrium.solve(load))
        spread = stiffness.k_n * mesh.length**2 / 12.0 * jump[:, 2]
        carried = run[:, None] * np.column_stack([springs * jump[:, :2], spread])
    force = carried[:, :1] * mesh.normal + carried[:, 1:2] * _tangent(mesh)
    total = load
    for element, sign in zip(mesh.interface_elements.T, (1.0, -1.0), strict=True):
        arm = mesh.midpoint - mesh.centre[element]
        moment = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0] + carried[:, 2]
        np.add.at(total, element, sign * np.column_stack([force, moment]))
    return float(np.abs(total / [1.0, 1.0, length]).max() / np.hypot(*force.T).max())


def load_resultant(mesh: Mesh) -> float:
    """Return the resultants of k_field over the largest facet's force (times its arm)."""
    start, end = (mesh.vertices[mesh.boundary_vertices[:, side]] for side in (0, 1))
    airy = williams_mode_one(2e4, mesh.notch)
    forces = facet_forces(start, end, np.zeros_like(start), airy)
    return float(np.max(np.abs(forces.sum(axis=0)) / np.abs(forces).max(axis=0)))


def _rms(mesh: Mesh, load: tuple[float, float, float]) -> float:
    _, tractions = solve_uniform(mesh, _springs(mesh, "homogeneous"), np.array([load]))
    square = ((tractions[0] - _exact_traction(mesh, load)) ** 2).sum(axis=1) * mesh.length
    return float(np.sqrt(square.sum() / mesh.length.sum()))


def _exact_traction(mesh: Mesh, load: tuple[float, float, float]) -> FloatArray:
    xx, yy, xy = load
    vector = mesh.normal @ np.array([[xx, xy], [xy, yy]])
    tangent = _tangent(mesh)
    return np.stack([(vector * mesh.normal).sum(1), (vector * tangent).sum(1)], axis=1)


def _tangent(mesh: Mesh) -> FloatArray:
    return np.stack([-mesh.normal[:, 1], mesh.normal[:, 0]], axis=1)


def _springs(mesh: Mesh, springs: str) -> Stiffness:
    return spring_stiffness(mesh, steel(springs))
