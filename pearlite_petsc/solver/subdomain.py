"""A rank's subdomain of a mesh: the elements it owns and all interfaces that touch them."""

import itertools
from dataclasses import dataclass, fields

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray, read_only
from pearlite_petsc.mechanics.kinematics import jump_operator, rotation_length, spring_constants
from pearlite_petsc.mechanics.springs import Stiffness
from pearlite_petsc.tessellation.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class SubdomainInterfaces:
    """All interfaces that touch a rank's own elements, by ascending number.

    Attributes:
        numbers: Global ones; (k,).
        elements: Local elements i, j of each; (k, 2).
        stiffness: Intact springs.
        length, midpoint, normal, kind, cementite_share: As in the mesh; (k,), (k, 2), (k, 2), (k,),
            (k,).
        fine: Whether both elements have the full resolution; (k,).
        junctions: At both ends; (k, 2).
        ends: Where those junctions are [um]; (k, 2, 2).
    """

    numbers: IntArray
    elements: IntArray
    stiffness: Stiffness
    length: FloatArray
    midpoint: FloatArray
    normal: FloatArray
    kind: IntArray
    cementite_share: FloatArray
    fine: BoolArray
    junctions: IntArray
    ends: FloatArray

    def __post_init__(self) -> None:
        _protect(self)
        _protect(self.stiffness)

    def spring_constants(self) -> FloatArray:
        """Return the intact k_n l, k_t l, k_n l^3/12; shape (k, 3)."""
        return spring_constants(self.stiffness, self.length)


@dataclass(frozen=True, slots=True, eq=False)
class SubdomainBoundary:
    """The facets of the window's boundary that are a rank's own elements'.

    Attributes:
        elements: The owned element of each facet, local; (q,).
        facet_start, facet_end: Ends of the facets [um]; (q, 2).
    """

    elements: IntArray
    facet_start: FloatArray
    facet_end: FloatArray

    def __post_init__(self) -> None:
        _protect(self)


@dataclass(frozen=True, slots=True, eq=False)
class Subdomain:
    """What one rank knows of the mesh. Local elements: owned ones first, then ghosts.

    Attributes:
        first_element: The first owned one.
        owned_count: Owned elements ("owned" in shapes).
        element_count: Elements of the whole mesh.
        element_numbers: Global numbers of the local elements; (owned + g,).
        centre: Of owned elements and ghosts [um]; (owned + g, 2).
        rotation_length: Scales rotations [um].
        interfaces: Those that touch owned elements.
        boundary: Facets of owned elements.
    """

    first_element: int
    owned_count: int
    element_count: int
    element_numbers: IntArray
    centre: FloatArray
    rotation_length: float
    interfaces: SubdomainInterfaces
    boundary: SubdomainBoundary

    def __post_init__(self) -> None:
        _protect(self)

    @property
    def owned_elements(self) -> slice:
        """Owned elements among all of the mesh."""
        return slice(self.first_element, self.first_element + self.owned_count)

    @property
    def ghosts(self) -> IntArray:
        """Global numbers of the ghosts, ascending; (g,)."""
        return self.element_numbers[self.owned_count :]

    @property
    def owns_interface(self) -> BoolArray:
        """Whether this rank owns an interface, which one rank does; (k,)."""
        owned: BoolArray = self.interfaces.elements[:, 0] < self.owned_count
        return owned

    def jump_operator(self) -> FloatArray:
        """Return B of the interfaces; shape (k, 3, 6)."""
        own = self.interfaces
        return jump_operator(
            self.centre, own.elements, own.midpoint, own.normal, self.rotation_length
        )

    def right_hand_side(self, load: FloatArray) -> FloatArray:
        """Return a load in the units of the unknowns; (3 owned,).

        Args:
            load: (F_x, F_y, M) on owned elements [uN, uN, uN um]; (owned, 3).
        """
        return np.asarray((load / np.array([1.0, 1.0, self.rotation_length])).ravel())


def _protect(part: Subdomain | SubdomainInterfaces | SubdomainBoundary | Stiffness) -> None:
    """Make the arrays of a part of the subdomain read-only."""
    for entry in fields(part):
        value = getattr(part, entry.name)
        if isinstance(value, np.ndarray):
            read_only(value)


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


def subdomain_of(mesh: Mesh, stiffness: Stiffness, first: int, last: int) -> Subdomain:
    """Return the subdomain of the rank that owns the elements first <= e < last."""
    pairs = mesh.interface_elements
    inside = (pairs >= first) & (pairs < last)
    chosen = np.flatnonzero(inside.any(axis=1))
    inside, near = inside[chosen], pairs[chosen]
    ghosts = np.unique(near[~inside])
    local = np.where(inside, near - first, last - first + np.searchsorted(ghosts, near))
    facets = (mesh.boundary_elements >= first) & (mesh.boundary_elements < last)
    return Subdomain(
        first_element=first,
        owned_count=last - first,
        element_count=mesh.element_count,
        element_numbers=np.concatenate([np.arange(first, last), ghosts]),
        centre=np.concatenate([mesh.centre[first:last], mesh.centre[ghosts]]),
        rotation_length=rotation_length(mesh),
        interfaces=_interfaces(mesh, stiffness, chosen, local),
        boundary=SubdomainBoundary(
            elements=mesh.boundary_elements[facets] - first,
            facet_start=mesh.vertices[mesh.boundary_vertices[facets, 0]],
            facet_end=mesh.vertices[mesh.boundary_vertices[facets, 1]],
        ),
    )


def _interfaces(
    mesh: Mesh, stiffness: Stiffness, numbers: IntArray, elements: IntArray
) -> SubdomainInterfaces:
    """Return some interfaces of the mesh.

    Args:
        mesh: The whole one.
        stiffness: Of all its interfaces.
        numbers: The chosen ones, ascending; (k,).
        elements: Their local elements; (k, 2).
    """
    junctions = mesh.junction[mesh.interface_vertices[numbers]]
    return SubdomainInterfaces(
        numbers=numbers,
        elements=elements,
        stiffness=Stiffness(stiffness.k_n[numbers], stiffness.k_t[numbers]),
        length=mesh.length[numbers],
        midpoint=mesh.midpoint[numbers],
        normal=mesh.normal[numbers],
        kind=mesh.kind[numbers],
        cementite_share=mesh.cementite_share[numbers],
        fine=mesh.fine[mesh.interface_elements[numbers]].all(axis=1),
        junctions=junctions,
        ends=_junction_places(mesh)[junctions],
    )
