"""The last step of meshing: from a diagram with labels to a `Mesh`."""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.microstructure.labels import LabelMap
from pearlite_petsc.scene import Kind, Window
from pearlite_petsc.tessellation.kinds import Facets, kinds_by_labels, shares_by_cut
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.notch import notch_run
from pearlite_petsc.tessellation.voronoi import (
    Diagram,
    cell_areas,
    merged_groups,
    oriented_facets,
)

DROPPING = 1e-3
"""Facets shorter than this share of sqrt(width * length) of an element are no interface."""


@dataclass(frozen=True, slots=True, eq=False)
class Labels:
    """Labels and direction of the lamellae [rad] of the elements; (n,) each."""

    prior_austenite_grain: IntArray
    block: IntArray
    colony: IntArray
    lamella_angle: FloatArray

    @property
    def levels(self) -> tuple[IntArray, IntArray, IntArray]:
        """Labels from the coarsest level to the finest."""
        return self.prior_austenite_grain, self.block, self.colony


def assemble(
    diagram: Diagram,
    centre: FloatArray,
    normal: FloatArray,
    candidates: BoolArray,
    labels: Labels,
    nucleus: IntArray,
    fine: BoolArray,
    window: Window,
    spacing: float,
    made_from: tuple[str, int, int],
    label_map: LabelMap | None = None,
) -> Mesh:
    """Drop facets that are too short, find the notch and the kinds, and put the mesh together.

    Args:
        diagram: Cells of n elements and k facets between them.
        centre: Of the elements [um]; (n, 2).
        normal: Unit normals of the facets, from the first to the second element; (k, 2).
        candidates: Facets on the notch line that may belong to the notch; (k,).
        labels: Of the elements.
        nucleus: Number of each element's nucleus; (n,).
        fine: Whether an element belongs to the fine zone; (n,).
        window: Size and notch [um].
        spacing: Mean spacing of the fine elements [um].
        made_from: State, index, seed.
        label_map: Microstructure that the kinds follow along each facet; None takes them from the
            labels of the elements.

    Raises:
        MeshError: The facets do not follow the notch.
    """
    vertices = diagram.vertices
    length = np.hypot(*(vertices[diagram.facets[:, 1]] - vertices[diagram.facets[:, 0]]).T)
    kept = length >= DROPPING * spacing
    pairs, normal = diagram.pairs[kept], normal[kept]
    facets = oriented_facets(vertices, diagram.facets[kept], normal)
    on_notch, tip = notch_run(vertices, facets, candidates[kept], window, spacing)
    distance = np.einsum("kd,kd->k", centre[pairs[:, 1]] - centre[pairs[:, 0]], normal)
    lines = Facets(vertices, facets, normal, pairs, distance, labels.levels, labels.lamella_angle)
    kind, cementite_share = _kinds(lines, label_map, on_notch)
    return Mesh(
        vertices=vertices,
        junction=merged_groups(len(vertices), diagram.facets[~kept]),
        centre=centre,
        area=cell_areas(vertices, diagram.offsets, diagram.vertex_indices),
        offsets=diagram.offsets,
        vertex_indices=diagram.vertex_indices,
        colony=labels.colony,
        block=labels.block,
        prior_austenite_grain=labels.prior_austenite_grain,
        lamella_angle=labels.lamella_angle,
        nucleus=nucleus,
        fine=fine,
        interface_elements=pairs,
        interface_vertices=facets,
        length=length[kept],
        midpoint=vertices[facets].mean(axis=1),
        normal=normal,
        kind=kind,
        cementite_share=cementite_share,
        boundary_elements=diagram.boundary,
        boundary_vertices=diagram.boundary_facets,
        window=(window.width, window.height),
        notch=tip,
        state=made_from[0],
        index=made_from[1],
        seed=made_from[2],
    )


def _kinds(
    facets: Facets, label_map: LabelMap | None, on_notch: BoolArray
) -> tuple[IntArray, FloatArray]:
    """Return the kind and the share of cementite of each facet; (k,) each."""
    if label_map is None:
        kind = kinds_by_labels(facets)
        cementite_share = (kind == Kind.CEMENTITE).astype(np.float64)
    else:
        shares = shares_by_cut(facets, label_map)
        kind, cementite_share = shares.argmax(axis=1), shares[:, Kind.CEMENTITE]
    kind[on_notch] = Kind.NOTCH
    return kind, cementite_share
