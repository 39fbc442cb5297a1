"""The mesh: rigid Voronoi elements and their interfaces."""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Elements, interfaces and boundary of one window; all arrays read-only.

    Elements are numbered along a space-filling curve. Polygons are counter-clockwise. The notch's
    interfaces (kind 5) are listed like all others but carry nothing. Facets shorter than the
    dropping length are no interface; their two vertices share one ``junction``, so that a crack
    passes over them.

    Attributes:
        vertices: [um]; (m, 2).
        junction: Junction of each vertex; (m,).
        centre: Nuclei, under affine shear the polygons' centroids [um]; (n, 2).
        area: [um^2]; (n,).
        offsets, vertex_indices: Polygon i is vertex_indices[offsets[i]:offsets[i + 1]]; (n + 1,), (.,).
        colony, block, prior_austenite_grain: Labels; (n,).
        lamella_angle: In [0, pi) [rad]; (n,).
        nucleus: Number of the nucleus in the uniformly fine lattice of this microstructure, negative
            for those along the wake of a crack, which are no part of it; (n,).
        fine: Whether the element belongs to the fine zone; (n,).
        interface_elements: Elements i < j of each interface; (k, 2).
        interface_vertices: (k, 2).
        length: [um], > 0; (k,).
        midpoint: [um]; (k, 2).
        normal: Unit normal of the facet, from i to j; (k, 2). It lies along the line of centres
            except under affine shear.
        kind: Values of scene.Kind; where a facet is of several, the one with the largest share;
            (k,).
        cementite_share: Share of the length that cuts cementite; (k,).
        boundary_elements: Element of each facet of the window's boundary; (q,).
        boundary_vertices: End vertices, counter-clockwise round the window; (q, 2).
        window: Width and height [um].
        notch: Tip of the notch as meshed [um], (x, y).
        state, index, seed: What the mesh was made from.
    """

    vertices: FloatArray
    junction: IntArray
    centre: FloatArray
    area: FloatArray
    offsets: IntArray
    vertex_indices: IntArray
    colony: IntArray
    block: IntArray
    prior_austenite_grain: IntArray
    lamella_angle: FloatArray
    nucleus: IntArray
    fine: BoolArray
    interface_elements: IntArray
    interface_vertices: IntArray
    length: FloatArray
    midpoint: FloatArray
    normal: FloatArray
    kind: IntArray
    cementite_share: FloatArray
    boundary_elements: IntArray
    boundary_vertices: IntArray
    window: tuple[float, float]
    notch: tuple[float, float]
    state: str
    index: int
    seed: int

    def __post_init__(self) -> None:
        for name in self.__slots__:
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    @property
    def element_count(self) -> int:
        """Number of elements n."""
        return len(self.centre)

    @property
    def interface_count(self) -> int:
        """Number of interfaces k, those of the notch included."""
        return len(self.length)
