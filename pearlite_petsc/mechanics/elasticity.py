"""Elastic constants that a mesh shows under uniform stress: its certificate."""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.mechanics.loads import uniform_stress
from pearlite_petsc.mechanics.springs import Stiffness, matched_ratio, spring_stiffness
from pearlite_petsc.mechanics.statics import solve_loads
from pearlite_petsc.scene import Material
from pearlite_petsc.tessellation.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Certificate:
    """Elastic constants of a mesh whose interfaces, the notch's included, are all intact.

    Attributes:
        e_x, e_y: Young's moduli along x and y [MPa].
        nu_xy, nu_yx: Poisson ratios, load along the first axis.
        g: Shear modulus [MPa].
        coupling: Largest shear strain over normal strain under tension along x or y.
        stress_error: Rms error of the interfaces' tractions over the applied stress, by length.
        compliance: Strain (xx, yy, 2 xy) for unit stress (xx, yy, xy) [1/MPa]; (3, 3).
    """

    e_x: float
    e_y: float
    nu_xy: float
    nu_yx: float
    g: float
    coupling: float
    stress_error: float
    compliance: FloatArray


def solve_uniform(
    mesh: Mesh, stiffness: Stiffness, stresses: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Solve the intact mesh under uniform stresses on its whole boundary with a direct solver.

    Args:
        mesh: The mesh.
        stiffness: Springs of all interfaces.
        stresses: Rows (xx, yy, xy) [MPa]; (s, 3).

    Returns:
        Unknowns (X, Y, phi) of each element; (s, n, 3), and interface tractions (normal,
        tangential) [MPa]; (s, k, 2).
    """
    intact = np.zeros(mesh.interface_count, dtype=np.bool_)
    loads = [uniform_stress(xx, yy, xy) for xx, yy, xy in stresses]
    found = solve_loads(mesh, stiffness, intact, loads)
    return np.stack([s.unknowns for s in found]), np.stack([s.traction for s in found])


def certificate(mesh: Mesh, stiffness: Stiffness) -> Certificate:
    """Return the elastic constants of the mesh under tension along x, y and pure shear.

    The strain is that of the linear field closest to the elements' displacements, weighted by
    their areas.
    """
    stresses = np.eye(3)
    motions, tractions = solve_uniform(mesh, stiffness, stresses)
    weight = np.sqrt(mesh.area / mesh.area.sum())
    basis = np.column_stack([np.ones(mesh.element_count), mesh.centre - mesh.centre.mean(axis=0)])
    fit = np.linalg.lstsq(
        basis * weight[:, None],
        np.swapaxes(motions[:, :, :2], 0, 1).reshape(-1, 6) * weight[:, None],
        rcond=None,
    )[0]
    gradient = fit[1:].reshape(2, 3, 2)  # (derivative along, load, displacement along)
    compliance = np.stack(
        [gradient[0, :, 0], gradient[1, :, 1], gradient[1, :, 0] + gradient[0, :, 1]]
    )
    tangent = np.stack([-mesh.normal[:, 1], mesh.normal[:, 0]], axis=1)
    errors = []
    for (xx, yy, xy), traction in zip(stresses[:2], tractions[:2], strict=True):
        exact = mesh.normal @ np.array([[xx, xy], [xy, yy]])
        wanted = np.stack([(exact * mesh.normal).sum(1), (exact * tangent).sum(1)], axis=1)
        square = ((traction - wanted)[:, 0] ** 2 * mesh.length).sum() / mesh.length.sum()
        errors.append(float(np.sqrt(square)))
    return Certificate(
        e_x=float(1.0 / compliance[0, 0]),
        e_y=float(1.0 / compliance[1, 1]),
        nu_xy=float(-compliance[1, 0] / compliance[0, 0]),
        nu_yx=float(-compliance[0, 1] / compliance[1, 1]),
        g=float(1.0 / compliance[2, 2]),
        coupling=float(np.max(np.abs(compliance[2, :2] / np.diag(compliance)[:2]))),
        stress_error=max(errors),
        compliance=compliance,
    )


def ratio_of_mesh(mesh: Mesh, material: Material) -> float | None:
    """Return k_t/k_n that ``matched`` springs need on this mesh, None for the other laws.

    Raises:
        PearliteError: The mesh cannot show the wanted Poisson ratio.
    """
    if not material.springs.meets_poisson_ratio:
        return None

    def poisson(ratio: float) -> float:
        found = certificate(mesh, spring_stiffness(mesh, material, ratio))
        return 0.5 * (found.nu_xy + found.nu_yx)

    return matched_ratio(poisson, material.poisson_ratio)
