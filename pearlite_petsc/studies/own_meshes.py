"""Stress intensity on the program's own meshes: energy release at the notch, traction at its tip."""

from dataclasses import replace

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.mechanics.elasticity import ratio_of_mesh
from pearlite_petsc.mechanics.lefm import edge_crack_factor
from pearlite_petsc.mechanics.loads import uniform_stress, williams_mode_one
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.mechanics.statics import solve
from pearlite_petsc.scene import Kind
from pearlite_petsc.studies.bodies import notch_between, on_line
from pearlite_petsc.studies.cases import STATES, STEEL, scene_of, steel
from pearlite_petsc.tessellation.build import build_mesh
from pearlite_petsc.tessellation.mesh import Mesh

STRIP = (200.0, 500.0, 64.0)
ADVANCE = 10.0
"""Growth over which the energy release is taken, the notch's last facets [um]."""


def strip_mesh(element: float, index: int) -> Mesh:
    """Return the program's graded mesh of a long strip, undeformed, fine about the notch's tip."""
    scene = scene_of(STRIP, (element, 2.0 * element), "follow")
    elements = replace(scene.elements, radius=max(16.0, 6.0 * element))
    return build_mesh(replace(scene, elements=elements), STATES["undeformed"], index)


def release_ratio(mesh: Mesh, springs: str) -> float:
    """Return K over Tada's from the energy that the notch's last facets release."""
    ratio = ratio_of_mesh(mesh, steel(springs))
    stiffness = spring_stiffness(mesh, steel(springs), ratio)
    notch = mesh.kind == Kind.NOTCH
    last = notch_between(mesh, mesh.notch[0] - ADVANCE, np.inf)
    start = float(mesh.vertices[mesh.interface_vertices[last], 0].min())
    load = uniform_stress(0.0, 1.0, 0.0)
    after, before = (solve(mesh, stiffness, cut, load).energy for cut in (notch, notch & ~last))
    middle, run = 0.5 * (start + mesh.notch[0]), mesh.notch[0] - start
    factor = edge_crack_factor(middle / mesh.window[0])
    expected = factor**2 * np.pi * middle / STEEL.youngs_modulus * run
    return float(np.sqrt((after - before) / expected))


def tip_tractions(mesh: Mesh, springs: str) -> FloatArray:
    """Return the normal traction ahead of a crack times sqrt(l)/K under ``k_field``; (t,).

    The crack is part of the notch, so that the interface ahead goes straight on; one value for each
    of the notch's inner facets as the one ahead.
    """
    notch = np.flatnonzero(mesh.kind == Kind.NOTCH)
    notch = notch[np.argsort(mesh.midpoint[notch, 0])]
    return _ahead(mesh, notch, range(len(notch) // 2, len(notch) - 3), springs)


def line_tractions(mesh: Mesh, tip: float, springs: str) -> FloatArray:
    """Return the same for a crack along the middle of a grid up to x = tip [um]; (1,)."""
    line = np.flatnonzero(on_line(mesh, 0.5 * mesh.window[1], 0.0, np.inf))
    line = line[np.argsort(mesh.midpoint[line, 0])]
    place = int(np.searchsorted(mesh.midpoint[line, 0], tip))
    return _ahead(mesh, line, range(place, place + 1), springs)


def _ahead(mesh: Mesh, line: IntArray, places: range, springs: str) -> FloatArray:
    k = 2e4
    stiffness = spring_stiffness(mesh, steel(springs), ratio_of_mesh(mesh, steel(springs)))
    values = []
    for place in places:
        ahead = int(line[place])
        cut = np.zeros(mesh.interface_count, dtype=np.bool_)
        cut[line[:place]] = True
        start = mesh.vertices[mesh.interface_vertices[ahead], 0].min()
        load = williams_mode_one(k, (float(start), 0.5 * mesh.window[1]))
        traction = solve(mesh, stiffness, cut, load).traction[ahead, 0]
        values.append(traction * np.sqrt(mesh.length[ahead]) / k)
    return np.array(values)
