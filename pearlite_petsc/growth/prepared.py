"""What all cracks of one microstructure share: substrate, first mesh, spring ratio."""

from dataclasses import dataclass

from pearlite_petsc.mechanics.elasticity import ratio_of_mesh
from pearlite_petsc.scene import Scene, State
from pearlite_petsc.tessellation.build import Substrate, prepare, tessellate
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.zone import FineZone, initial_zone


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """A microstructure ready for growth.

    Attributes:
        substrate: Labels and nuclei.
        zone: Fine zone at the start.
        mesh: Mesh at the start.
        ratio: k_t/k_n of ``matched`` springs on that mesh, None for the other laws.
    """

    substrate: Substrate
    zone: FineZone
    mesh: Mesh
    ratio: float | None


def prepare_growth(scene: Scene, state: State, index: int) -> Prepared:
    """Make the microstructure and first mesh of one repetition.

    Raises:
        MeshError: The window cannot hold a mesh.
        PearliteError: The spring law does not fit the mesh.
    """
    substrate = prepare(scene, state, index)
    zone = initial_zone(scene)
    mesh = tessellate(substrate, zone)
    return Prepared(substrate, zone, mesh, ratio_of_mesh(mesh, scene.material))
