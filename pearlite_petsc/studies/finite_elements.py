"""The cracked bodies in finite elements (scikit-fem), for comparison."""

import itertools
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from scipy.sparse.linalg import splu

from pearlite_petsc.studies.cases import STEEL
from pearlite_petsc.studies.cracked_bodies import BASE, LAYERS, CrackedBody, layers

Order = Literal[1, 2]
"""Linear or quadratic triangles."""

EQUAL_UNKNOWNS = np.sqrt(1.5)
"""Nodes per element of the other method along each axis: two unknowns a node against three."""


def finite_element_ratio(body: CrackedBody, size: float, order: Order = 1) -> tuple[int, float]:
    """Return unknowns of the whole body and K over the handbook's on triangles.

    The upper half is solved (the lower one is its mirror image); K comes from the energy release
    between the same two crack lengths, at which nodes lie.

    Args:
        body: Strip and crack.
        size: Width of the triangles at the crack's line [um].
        order: Of the triangles.

    Raises:
        ImportError: scikit-fem is not installed.
    """
    from skfem import MeshTri

    keys = sorted({0.0, body.width, *body.ends(body.before), *body.ends(body.after)})
    runs = [
        np.linspace(start, end, max(1, round((end - start) / size)) + 1)[:-1]
        for start, end in itertools.pairwise(keys)
    ]
    x = np.concatenate([*runs, [body.width]])
    mesh = MeshTri.init_tensor(x, layers(round(LAYERS * BASE / size)))
    unknowns, energy = _energies(mesh, order, [body.ends(a) for a in (body.before, body.after)])
    return unknowns, float(np.sqrt((energy[1] - energy[0]) / body.handbook_release()))


def _energies(
    mesh: Any, order: Order, cracks: Sequence[tuple[float, float]]
) -> tuple[int, list[float]]:
    """Return unknowns and, for each crack, energy under unit stress [uN um] of the whole body.

    The ligament at y = 0 is held along y.
    """
    from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, FacetBasis, LinearForm, asm
    from skfem.models.elasticity import linear_elasticity

    modulus, nu = STEEL.youngs_modulus, STEEL.poisson_ratio
    element = ElementVector(ElementTriP1() if order == 1 else ElementTriP2())
    basis = Basis(mesh, element)
    plane_stress = modulus * nu / (1.0 - nu**2), modulus / (2.0 * (1.0 + nu))
    matrix = asm(linear_elasticity(*plane_stress), basis).tocsc()
    top = mesh.facets_satisfying(lambda p: p[1] == mesh.p[1].max())
    load = asm(LinearForm(lambda v, w: v[1]), FacetBasis(mesh, element, facets=top))
    corner = np.argmax(mesh.p[0] - mesh.p[1])
    energies = []
    for first, last in cracks:
        # A facet's midpoint lies off its ends: only facets beside the crack are found.
        ligament = mesh.facets_satisfying(
            lambda p, first=first, last=last: (p[1] == 0.0) & ((p[0] < first) | (p[0] > last)),
            boundaries_only=True,
        )
        vertical = basis.get_dofs(ligament).all(["u^2"])
        held = np.append(vertical, basis.nodal_dofs[0, corner])
        free = np.setdiff1d(np.arange(len(load)), held)
        factor = splu(
            matrix[free][:, free], permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
        )
        energies.append(float(load[free] @ factor.solve(load[free])))
    line = basis.get_dofs(mesh.facets_satisfying(lambda p: p[1] == 0.0, boundaries_only=True))
    return 2 * len(load) - len(line.all()), energies
