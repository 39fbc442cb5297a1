"""From a scene to a mesh: one substrate a microstructure, any number of graded meshes of it."""

from dataclasses import dataclass, replace

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.errors import MeshError
from pearlite_petsc.microstructure.labels import LabelMap, make_label_map
from pearlite_petsc.scene import Elements, Kind, Scene, State, Window
from pearlite_petsc.tessellation.affine import affine_mesh
from pearlite_petsc.tessellation.assemble import Labels, assemble
from pearlite_petsc.tessellation.curve import hilbert_order
from pearlite_petsc.tessellation.grading import notch_guard, spacing_factor
from pearlite_petsc.tessellation.levels import GROWTH, coarsening_levels, level_of
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.notch import NotchGapError
from pearlite_petsc.tessellation.nuclei import fine_nuclei
from pearlite_petsc.tessellation.voronoi import bounded_voronoi
from pearlite_petsc.tessellation.wake import SpacingAt, Wake
from pearlite_petsc.tessellation.wake_facets import wake_facets
from pearlite_petsc.tessellation.wake_nuclei import WakeNuclei, wake_nuclei
from pearlite_petsc.tessellation.zone import FineZone, initial_zone

FEWEST = 10
"""Least number of elements of a mesh."""


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
        notch_guard(points, window, elements),
    )


def build_mesh(scene: Scene, state: State, index: int) -> Mesh:
    """Return the mesh that the growth of a crack starts with.

    Raises:
        MeshError: The window cannot hold a mesh.
    """
    return tessellate(prepare(scene, state, index), initial_zone(scene))


def tessellate(
    substrate: Substrate, zone: FineZone, keep: IntArray | None = None, wake: Wake | None = None
) -> Mesh:
    """Return a mesh that is fine in a zone and coarsens away from it.

    Args:
        substrate: Microstructure and nuclei.
        zone: Where the resolution is full.
        keep: Numbers of nuclei that stay whatever their distance, those of damaged interfaces.
        wake: The crack where its elements may coarsen; its facets are of the kind of the notch.

    Returns:
        The mesh; under affine shear, which knows no grading, always the same one.

    Raises:
        MeshError: Fewer than ten elements, or a notch that the elements cannot follow.
    """
    if substrate.affine is not None:
        return substrate.affine
    elements = substrate.elements
    factor = spacing_factor(elements, zone, wake, substrate.points)
    fine = factor <= 1.0
    factor = np.minimum(factor, substrate.guard)
    chosen = substrate.level >= level_of(factor, elements.coarsest)
    if keep is not None:
        chosen[keep] = fine[keep] = True
    # A zone that is not symmetric must not take one half of a mirror pair alone.
    mirrored = np.flatnonzero(substrate.partner >= 0)
    chosen[mirrored] |= chosen[substrate.partner[mirrored]]
    spacing_at = _spacing_at(substrate, zone, wake)
    along = None
    if wake is not None:
        stays = substrate.partner >= 0
        if keep is not None:
            stays[keep] = True
        along = wake_nuclei(wake, spacing_at, substrate.points[chosen & stays], elements.length)
        free = np.flatnonzero(chosen & ~stays)
        chosen[free[along.spoiled_by(substrate.points[free])]] = False
    reach = 1.5 * np.maximum(substrate.spacing * GROWTH * factor, elements.length)
    while True:
        nucleus = np.flatnonzero(chosen).astype(np.int64)
        if len(nucleus) < FEWEST:
            raise MeshError(f"mesh has {len(nucleus)} elements, at least {FEWEST} are needed")
        try:
            mesh = _mesh(substrate, nucleus, reach[nucleus], fine[nucleus], along)
        except NotchGapError as gap:
            # A nucleus without an image lies closest there: mirror pairs between it and the line.
            x = substrate.points[:, 0]
            near = (x > gap.start - reach) & (x < gap.end + reach) & (substrate.partner >= 0)
            if not (near & ~chosen).any():
                raise
            chosen |= near
        else:
            break
    if wake is None or along is None:
        return mesh
    cut = wake_facets(mesh, wake, along.lines, spacing_at)
    return replace(mesh, kind=np.where(cut, int(Kind.NOTCH), mesh.kind))


def _spacing_at(substrate: Substrate, zone: FineZone, wake: Wake | None) -> SpacingAt:
    """Return the spacing of the nuclei as a function of the place."""
    elements, window = substrate.elements, substrate.window

    def spacing_at(points: FloatArray) -> FloatArray:
        guard = notch_guard(points, window, elements)
        return substrate.spacing * np.minimum(spacing_factor(elements, zone, wake, points), guard)

    return spacing_at


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


def _mesh(
    substrate: Substrate,
    nucleus: IntArray,
    reach: FloatArray,
    fine: BoolArray,
    along: WakeNuclei | None = None,
) -> Mesh:
    window, centre = substrate.window, substrate.points[nucleus]
    grain, block, colony = (
        labels[nucleus]
        for labels in (substrate.prior_austenite_grain, substrate.block, substrate.colony)
    )
    if along is not None and len(along.points):
        count = len(along.points)
        order = hilbert_order(np.concatenate([centre, along.points]))
        centre = np.concatenate([centre, along.points])[order]
        # Negative: no interface of theirs is one of the microstructure.
        nucleus = np.concatenate([nucleus, -1 - np.arange(count)])[order]
        reach = np.concatenate([reach, 3.0 * along.spacing])[order]
        fine = np.concatenate([fine, np.zeros(count, dtype=np.bool_)])[order]
        grain, block, colony = (
            np.concatenate(both)[order]
            for both in zip(
                (grain, block, colony), substrate.label_map.labels(along.points), strict=True
            )
        )
    diagram = bounded_voronoi(centre, window.width, window.height, reach)
    pairs = diagram.pairs
    partner = np.where(nucleus >= 0, substrate.partner[nucleus], -1)
    mirrored = partner[pairs[:, 0]] == nucleus[pairs[:, 1]]
    mirrored &= nucleus[pairs[:, 1]] >= 0
    # Mirror pairs share a facet on the notch line up to rounding.
    diagram.vertices[diagram.facets[mirrored].ravel(), 1] = 0.5 * window.height
    gap = centre[pairs[:, 1]] - centre[pairs[:, 0]]
    normal = gap / np.hypot(gap[:, 0], gap[:, 1])[:, None]
    made_from = substrate.state.name, substrate.index, substrate.seed
    return assemble(
        diagram,
        centre,
        normal,
        mirrored,
        Labels(grain, block, colony, substrate.label_map.lamella_angle[colony]),
        nucleus,
        fine,
        window,
        substrate.spacing,
        made_from,
        substrate.label_map if substrate.elements.kinds == "cut" else None,
    )
