"""From a scene to a mesh: one substrate a microstructure, any number of graded meshes of it."""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.errors import MeshError
from pearlite_petsc.microstructure.labels import LabelMap, make_label_map
from pearlite_petsc.scene import Elements, Scene, State, Window
from pearlite_petsc.tessellation.affine import affine_mesh
from pearlite_petsc.tessellation.assemble import Labels, assemble
from pearlite_petsc.tessellation.curve import hilbert_order
from pearlite_petsc.tessellation.levels import GROWTH, coarsening_levels, level_of
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.notch import NotchGapError
from pearlite_petsc.tessellation.nuclei import fine_nuclei, notch_band
from pearlite_petsc.tessellation.voronoi import bounded_voronoi
from pearlite_petsc.tessellation.zone import FineZone, initial_zone

FEWEST = 10
"""Least number of elements of a mesh."""

FLANK_FACTOR, FLANK_GROWTH = 2.0, 0.3
"""Coarsest spacing along the notch, as a multiple of the fine one, and its growth per um."""


@dataclass(frozen=True, slots=True, eq=False)
class Substrate:
    """What all meshes of one microstructure share: labels and the nuclei at full resolution.

    Nuclei are numbered along a space-filling curve; the number is `Mesh.nucleus`.

    Attributes:
        window, elements, state: Parts of the scene.
        index, seed: Of the mesh and of the microstructure.
        label_map: The microstructure.
        points: Nuclei [um]; (n, 2).
        partner: Mirror image across the notch, -1 for none; (n,).
        level: Last coarsening level at which each is still there; (n,).
        prior_austenite_grain, block, colony: Labels; (n,).
        lamella_angle: [rad]; (n,).
        guard: Largest factor of the spacing that the notch allows; (n,).
        affine: The one mesh under affine shear, whose elements the arrays above then describe.
    """

    window: Window
    elements: Elements
    state: State
    index: int
    seed: int
    label_map: LabelMap
    points: FloatArray
    partner: IntArray
    level: IntArray
    prior_austenite_grain: IntArray
    block: IntArray
    colony: IntArray
    lamella_angle: FloatArray
    guard: FloatArray
    affine: Mesh | None = None

    @property
    def spacing(self) -> float:
        """Mean spacing of the nuclei at full resolution [um]."""
        return float(np.sqrt(self.elements.width * self.elements.length))


def prepare(scene: Scene, state: State, index: int) -> Substrate:
    """Make the microstructure and the fine nuclei of one mesh.

    A pure function of its arguments; nothing depends on the fine zone.

    Args:
        scene: Sizes, window, elements.
        state: Shear strain and orientation.
        index: Number of the mesh, >= 0.

    Raises:
        MeshError: The window cannot hold a mesh.
    """
    if index < 0:
        raise MeshError(f"mesh index {index} is negative")
    window, elements, seed = scene.window, scene.elements, scene.microstructure.seed
    label_map = make_label_map(scene.microstructure, window, state, index)
    if elements.shear == "affine":
        return _affine_substrate(scene, state, index, label_map)
    nuclei = fine_nuclei(label_map, elements, window, seed, index)
    if len(nuclei.points) < FEWEST:
        raise MeshError(
            f"window of {window.width:g} x {window.height:g} um holds {len(nuclei.points)} "
            f"elements of {elements.width:g} x {elements.length:g} um, at least {FEWEST} are needed"
        )
    order = hilbert_order(nuclei.points)
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    points = nuclei.points[order]
    partner = nuclei.partner[order]
    partner = np.where(partner >= 0, place[partner], -1)
    if elements.refinement == "uniform":
        # On the last level at every place: no zone can take them away.
        level = np.repeat(level_of(np.array([elements.coarsest]), elements.coarsest), len(points))
    else:
        spacing = float(np.sqrt(elements.width * elements.length))
        level = coarsening_levels(
            points, partner, nuclei.priority[order], spacing, elements.coarsest
        )
    grain, block, colony = label_map.labels(points)
    return Substrate(
        window,
        elements,
        state,
        index,
        seed,
        label_map,
        points,
        partner,
        level,
        grain,
        block,
        colony,
        label_map.lamella_angle[colony],
        _notch_guard(points, window, elements),
    )


def build_mesh(scene: Scene, state: State, index: int) -> Mesh:
    """Return the mesh that the growth of a crack starts with.

    Raises:
        MeshError: The window cannot hold a mesh.
    """
    return tessellate(prepare(scene, state, index), initial_zone(scene))


def tessellate(substrate: Substrate, zone: FineZone, keep: IntArray | None = None) -> Mesh:
    """Return a mesh that is fine in a zone and coarsens away from it.

    Args:
        substrate: Microstructure and nuclei.
        zone: Where the resolution is full.
        keep: Numbers of nuclei that stay whatever their distance, those of damaged interfaces.

    Returns:
        The mesh; under affine shear, which knows no grading, always the same one.

    Raises:
        MeshError: Fewer than ten elements, or a notch that the elements cannot follow.
    """
    if substrate.affine is not None:
        return substrate.affine
    elements = substrate.elements
    factor = 1.0 + elements.coarsening * zone.distance(substrate.points)
    fine = factor <= 1.0
    factor = np.minimum(np.minimum(factor, substrate.guard), max(elements.coarsest, 1.0))
    chosen = substrate.level >= level_of(factor, elements.coarsest)
    if keep is not None:
        chosen[keep] = fine[keep] = True
    # A zone that is not symmetric must not take one half of a mirror pair alone.
    mirrored = np.flatnonzero(substrate.partner >= 0)
    chosen[mirrored] |= chosen[substrate.partner[mirrored]]
    reach = 1.5 * np.maximum(substrate.spacing * GROWTH * factor, elements.length)
    while True:
        nucleus = np.flatnonzero(chosen).astype(np.int64)
        if len(nucleus) < FEWEST:
            raise MeshError(f"mesh has {len(nucleus)} elements, at least {FEWEST} are needed")
        try:
            return _mesh(substrate, nucleus, reach[nucleus], fine[nucleus])
        except NotchGapError as gap:
            # A nucleus without an image lies closest there: mirror pairs between it and the line.
            x = substrate.points[:, 0]
            near = (x > gap.start - reach) & (x < gap.end + reach) & (substrate.partner >= 0)
            if not (near & ~chosen).any():
                raise
            chosen |= near


def _affine_substrate(scene: Scene, state: State, index: int, label_map: LabelMap) -> Substrate:
    seed = scene.microstructure.seed
    mesh = affine_mesh(label_map, scene.elements, scene.window, state, seed, index)
    if mesh.element_count < FEWEST:
        raise MeshError(f"mesh has {mesh.element_count} elements, at least {FEWEST} are needed")
    count = mesh.element_count
    return Substrate(
        scene.window,
        scene.elements,
        state,
        index,
        seed,
        label_map,
        points=mesh.centre,
        partner=np.full(count, -1, dtype=np.int64),
        level=np.zeros(count, dtype=np.int64),
        prior_austenite_grain=mesh.prior_austenite_grain,
        block=mesh.block,
        colony=mesh.colony,
        lamella_angle=mesh.lamella_angle,
        guard=np.ones(count),
        affine=mesh,
    )


def _notch_guard(points: FloatArray, window: Window, elements: Elements) -> FloatArray:
    """Return the spacing factor up to which the notch stays straight and its tip where it is.

    Elements at the notch must find their neighbours inside the band of mirror nuclei, and
    refinement must not move the tip.
    """
    away = np.hypot(
        np.maximum(points[:, 0] - window.notch, 0.0), points[:, 1] - 0.5 * window.height
    )
    tip = np.hypot(points[:, 0] - window.notch, points[:, 1] - 0.5 * window.height)
    flank = FLANK_FACTOR + FLANK_GROWTH * np.maximum(away - notch_band(elements), 0.0)
    return np.minimum(flank, 1.0 + FLANK_GROWTH * np.maximum(tip - 2.0 * elements.length, 0.0))


def _mesh(substrate: Substrate, nucleus: IntArray, reach: FloatArray, fine: BoolArray) -> Mesh:
    window, centre = substrate.window, substrate.points[nucleus]
    diagram = bounded_voronoi(centre, window.width, window.height, reach)
    pairs = diagram.pairs
    mirrored = substrate.partner[nucleus[pairs[:, 0]]] == nucleus[pairs[:, 1]]
    # Mirror pairs share a facet on the notch line up to rounding.
    diagram.vertices[diagram.facets[mirrored].ravel(), 1] = 0.5 * window.height
    gap = centre[pairs[:, 1]] - centre[pairs[:, 0]]
    normal = gap / np.hypot(gap[:, 0], gap[:, 1])[:, None]
    labels = Labels(
        substrate.prior_austenite_grain[nucleus],
        substrate.block[nucleus],
        substrate.colony[nucleus],
        substrate.lamella_angle[nucleus],
    )
    made_from = substrate.state.name, substrate.index, substrate.seed
    return assemble(
        diagram,
        centre,
        normal,
        mirrored,
        labels,
        nucleus,
        fine,
        window,
        substrate.spacing,
        made_from,
        substrate.label_map if substrate.elements.kinds == "cut" else None,
    )
