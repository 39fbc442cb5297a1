"""Clusters of elements that broken interfaces have cut off."""

import numpy as np
from scipy.cluster.hierarchy import DisjointSet
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pearlite_petsc.arrays import BoolArray, IntArray
from pearlite_petsc.errors import SolverError
from pearlite_petsc.tessellation.mesh import Mesh


class LooseClusters:
    """Finds loose clusters; the search runs only after a break that closes a ring.

    In the plane a cluster comes loose exactly when broken interfaces (with the window's boundary)
    close a ring round it, which disjoint sets of their ends notice.
    """

    def __init__(self, mesh: Mesh, broken: BoolArray) -> None:
        self._mesh = mesh
        self._broken = np.zeros_like(broken)
        self._begin()
        self.add(np.flatnonzero(broken))

    def foresee(self, fresh: IntArray) -> None:
        """Look what breaks on trial would cut off, those before that were not added left out.

        Args:
            fresh: Their numbers.

        Raises:
            SolverError: A cluster is cut off that carries boundary load.
        """
        if not self._tried.issubset(fresh.tolist()):
            self._begin()
        new = [number for number in fresh.tolist() if number not in self._tried]
        self._tried.update(new)
        ends = self._mesh.junction[self._mesh.interface_vertices[new]]
        rings = [not self._join(a, b) for a, b in ends.tolist()]
        if any(rings):
            broken = self._broken.copy()
            broken[list(self._tried)] = True
            self._search(broken)

    def add(self, fresh: IntArray) -> None:
        """Add newly broken interfaces, tried before or not; raises as ``foresee``."""
        self.foresee(fresh)
        self._broken[fresh] = True
        self._tried.clear()

    def _begin(self) -> None:
        """Join what is broken anew, with the window's boundary."""
        self._connected = DisjointSet()
        self._tried: set[int] = set()
        self.loose = np.zeros(self._mesh.element_count, dtype=bool)
        border = self._mesh.junction[self._mesh.boundary_vertices].ravel()
        for junction in border[1:]:
            self._join(int(border[0]), int(junction))
        if self._broken.any():
            self.foresee(np.flatnonzero(self._broken))
            self._tried.clear()

    def _join(self, a: int, b: int) -> bool:
        """Join two junctions; return False where they were connected already."""
        for junction in (a, b):
            self._connected.add(junction)
        return bool(self._connected.merge(a, b))

    def _search(self, broken: BoolArray) -> None:
        mesh = self._mesh
        i, j = mesh.interface_elements[~broken].T
        shape = (mesh.element_count, mesh.element_count)
        graph = coo_array((np.ones(len(i), dtype=np.int8), (i, j)), shape=shape)
        _, label = connected_components(graph, directed=False)
        self.loose = label != np.bincount(label).argmax()
        loaded = self.loose[mesh.boundary_elements]
        if loaded.any():
            element = int(mesh.boundary_elements[np.flatnonzero(loaded)[0]])
            x, y = mesh.centre[element]
            size = int((label == label[element]).sum())
            right = float(mesh.midpoint[broken, 0].max())
            raise SolverError(
                f"a cluster of {size} elements about element {element} at ({x:.1f}, {y:.1f}) um is "
                f"cut off and carries boundary load: no equilibrium exists. Breaks, joined to the "
                f"crack or not, reach as far as x = {right:.1f} um and close a ring with the window's "
                "edge"
            )
