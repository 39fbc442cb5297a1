"""The cracked bodies in linear finite elements (scikit-fem), for comparison."""

import itertools
from typing import Any

import numpy as np
from scipy.sparse.linalg import splu

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.studies.cases import STEEL
from pearlite_petsc.studies.verification.cracked_bodies import BASE, CrackedBody, layers

EQUAL_UNKNOWNS = np.sqrt(1.5)
"""Nodes per element of the other method along each axis: two unknowns a node against three."""


def finite_element_ratio(body: CrackedBody, element: float) -> tuple[int, float]:
    """Return unknowns and K over the handbook's on linear triangles.

    The upper half is solved (the lower one is its mirror image); K comes from the energy release
    between the same two crack lengths, at which nodes lie. Unknowns are those of the whole body.

    Args:
        body: Strip and crack.
        element: Width of the rigid elements to be compared with [um].

    Raises:
        ImportError: scikit-fem is not installed.
    """
    from skfem import MeshTri

    size = element / EQUAL_UNKNOWNS
    keys = sorted({0.0, body.width, *body.ends(body.before), *body.ends(body.after)})
    x = np.concatenate(
        [
            np.linspace(start, end, max(1, round((end - start) / size)) + 1)[:-1]
            for start, end in itertools.pairwise(keys)
        ]
        + [[body.width]]
    )
    y = layers(round(13 * BASE / size))
    mesh = MeshTri.init_tensor(x, y)
    energy = [_energy(mesh, body.ends(a)) for a in (body.before, body.after)]
    unknowns = 2 * len(x) * (2 * len(y) - 1)
    return unknowns, float(np.sqrt((energy[1] - energy[0]) / body.handbook_release()))


def _energy(mesh: Any, crack: tuple[float, float]) -> float:
    """Return the energy of the whole body under unit stress [uN um]."""
    from skfem import Basis, ElementTriP1, ElementVector, FacetBasis, LinearForm, asm
    from skfem.models.elasticity import linear_elasticity

    modulus, nu = STEEL.youngs_modulus, STEEL.poisson_ratio
    element = ElementVector(ElementTriP1())
    basis = Basis(mesh, element)
    plane_stress = modulus * nu / (1.0 - nu**2), modulus / (2.0 * (1.0 + nu))
    matrix = asm(linear_elasticity(*plane_stress), basis).tocsc()
    top = mesh.p[1].max()
    edge = FacetBasis(mesh, element, facets=mesh.facets_satisfying(lambda p: p[1] == top))
    load = asm(LinearForm(lambda v, w: v[1]), edge)
    nodes = mesh.p
    ligament = (nodes[1] == 0.0) & ((nodes[0] <= crack[0]) | (nodes[0] >= crack[1]))
    if crack[0] == 0.0:
        ligament &= nodes[0] >= crack[1]
    fixed = basis.nodal_dofs[1, ligament]
    corner = np.argmax(nodes[0] - nodes[1])
    held = np.append(fixed, basis.nodal_dofs[0, corner])
    free: FloatArray = np.setdiff1d(np.arange(len(load)), held)
    solution = splu(
        matrix[free][:, free], permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
    ).solve(load[free])
    return float(load[free] @ solution)
