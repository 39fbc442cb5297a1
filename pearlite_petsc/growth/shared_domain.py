"""The domain of a microstructure's first mesh, which its cracks take one after the other."""

from mpi4py import MPI

from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.prepared import Prepared
from pearlite_petsc.scene import Scene


class SharedDomain:
    """Keeps the last microstructure's first domain: matrix and preconditioner. Collective.

    Args:
        comm: The group.
        scene: The scene.
    """

    def __init__(self, comm: MPI.Comm, scene: Scene) -> None:
        self._comm, self._scene = comm, scene
        self._microstructure = -1
        self._domain: Domain | None = None

    def domain(self, microstructure: int, prepared: Prepared | None) -> Domain:
        """Return the domain as it is at the start; it stays this object's to close.

        Args:
            microstructure: Its number in the ensemble.
            prepared: Substrate and first mesh on rank 0, None elsewhere.
        """
        if self._domain is not None and self._microstructure == microstructure:
            self._domain.rewind()
            return self._domain
        self.close()
        self._domain = first_domain(self._comm, self._scene, prepared, keep_first=True)
        self._microstructure = microstructure
        return self._domain

    def close(self) -> None:
        """Destroy the PETSc objects; a later ``domain`` makes them anew."""
        if self._domain is not None:
            self._domain.close()
            self._domain = None


def first_domain(
    comm: MPI.Comm, scene: Scene, prepared: Prepared | None, keep_first: bool = False
) -> Domain:
    """Return the domain of the first mesh with its notch. Collective.

    Args:
        comm: The group.
        scene: The scene.
        prepared: Substrate and first mesh on rank 0, None elsewhere.
        keep_first: Whether ``Domain.rewind`` will be wanted.
    """
    mesh, ratio = (None, None) if prepared is None else (prepared.mesh, prepared.ratio)
    return Domain(comm, scene, mesh, ratio, keep_first=keep_first)
