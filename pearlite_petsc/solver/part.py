"""A rank's share of a mesh: its own elements and all interfaces that touch them."""

import itertools
from dataclasses import dataclass, fields

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.mechanics.kinematics import jump_operator, rotation_length, spring_constants
from pearlite_petsc.mechanics.springs import Stiffness
from pearlite_petsc.tessellation.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """What one rank knows of the mesh. Local elements: own ones first, then ghosts.

    Attributes:
        first, own, total: First own element, number of own ones and of all elements.
        numbers: Global numbers of the local elements; (own + g,).
        centre: Of own elements and ghosts [um]; (own + g, 2).
        interface: Global numbers of the interfaces; (k,).
        pairs: Local elements i, j of each interface; (k, 2).
        stiffness: Intact springs of the interfaces.
        length, midpoint, normal, kind: Of each interface; (k,), (k, 2), (k, 2), (k,).
        fine: Whether both elements have the full resolution; (k,).
        junctions: At both ends of each interface; (k, 2).
        ends: Where those junctions are [um]; (k, 2, 2).
        rotation: Length that scales rotations [um].
        facet: Own elements of the boundary's facets, local; (q,).
        facet_start, facet_end: Ends of the facets [um]; (q, 2).
    """

    first: int
    own: int
    total: int
    numbers: IntArray
    centre: FloatArray
    interface: IntArray
    pairs: IntArray
    stiffness: Stiffness
    length: FloatArray
    midpoint: FloatArray
    normal: FloatArray
    kind: IntArray
    fine: BoolArray
    junctions: IntArray
    ends: FloatArray
    rotation: float
    facet: IntArray
    facet_start: FloatArray
    facet_end: FloatArray

    @property
    def ghosts(self) -> IntArray:
        """Global numbers of the ghosts, ascending; (g,)."""
        return self.numbers[self.own :]

    @property
    def owned(self) -> BoolArray:
        """Whether this rank owns an interface, which one rank does; (k,)."""
        owned: BoolArray = self.pairs[:, 0] < self.own
        return owned

    @property
    def nbytes(self) -> int:
        """Memory of the arrays [bytes]."""
        values = (getattr(self, entry.name) for entry in fields(self))
        return sum(value.nbytes for value in values if isinstance(value, np.ndarray))

    def jump_operator(self) -> FloatArray:
        """Return B of the part's interfaces; shape (k, 3, 6)."""
        return jump_operator(self.centre, self.pairs, self.midpoint, self.normal, self.rotation)

    def right_hand_side(self, load: FloatArray) -> FloatArray:
        """Return a load in the units of the unknowns; (3 own,).

        Args:
            load: (F_x, F_y, M) on own elements [uN, uN, uN um]; (own, 3).
        """
        return np.asarray((load / np.array([1.0, 1.0, self.rotation])).ravel())

    def spring_constants(self) -> FloatArray:
        """Return the intact k_n l, k_t l, k_n l^3/12 of the part's interfaces; shape (k, 3)."""
        return spring_constants(self.stiffness, self.length)


def element_ranges(total: int, ranks: int) -> list[tuple[int, int]]:
    """Return (first, last + 1) of the elements that each rank owns."""
    bounds = [total * rank // ranks for rank in range(ranks + 1)]
    return list(itertools.pairwise(bounds))


def _junction_places(mesh: Mesh) -> FloatArray:
    """Return the mean of each junction's vertices [um]; (m, 2).

    One place whichever of its interfaces breaks first, and mirrored in a mirrored mesh.
    """
    count = np.maximum(np.bincount(mesh.junction, minlength=len(mesh.vertices)), 1)
    sums = [
        np.bincount(mesh.junction, weights=values, minlength=len(mesh.vertices))
        for values in mesh.vertices.T
    ]
    return np.asarray(np.stack(sums, axis=1) / count[:, None])


def make_part(mesh: Mesh, stiffness: Stiffness, first: int, last: int) -> Part:
    """Return the share of the rank that owns the elements first <= e < last."""
    pairs = mesh.interface_elements
    inside = (pairs >= first) & (pairs < last)
    chosen = np.flatnonzero(inside.any(axis=1))
    inside, near = inside[chosen], pairs[chosen]
    ghosts = np.unique(near[~inside])
    junctions = mesh.junction[mesh.interface_vertices[chosen]]
    facets = (mesh.boundary_elements >= first) & (mesh.boundary_elements < last)
    return Part(
        first=first,
        own=last - first,
        total=mesh.element_count,
        numbers=np.concatenate([np.arange(first, last), ghosts]),
        centre=np.concatenate([mesh.centre[first:last], mesh.centre[ghosts]]),
        interface=chosen,
        pairs=np.where(inside, near - first, last - first + np.searchsorted(ghosts, near)),
        stiffness=Stiffness(stiffness.k_n[chosen], stiffness.k_t[chosen]),
        length=mesh.length[chosen],
        midpoint=mesh.midpoint[chosen],
        normal=mesh.normal[chosen],
        kind=mesh.kind[chosen],
        fine=mesh.fine[pairs[chosen]].all(axis=1),
        junctions=junctions,
        ends=_junction_places(mesh)[junctions],
        rotation=rotation_length(mesh),
        facet=mesh.boundary_elements[facets] - first,
        facet_start=mesh.vertices[mesh.boundary_vertices[facets, 0]],
        facet_end=mesh.vertices[mesh.boundary_vertices[facets, 1]],
    )
