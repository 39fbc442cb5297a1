"""What the normals of an element add up to."""

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.tessellation.mesh import Mesh


def outward_sums(mesh: Mesh) -> FloatArray:
    """Return each element's sum of outward normals times length, zero for a closed one; (n, 2)."""
    outward = np.zeros((mesh.element_count, 2))
    force = mesh.normal * mesh.length[:, None]
    np.add.at(outward, mesh.interface_elements[:, 0], force)
    np.add.at(outward, mesh.interface_elements[:, 1], -force)
    ends = mesh.vertices[mesh.boundary_vertices]
    step = ends[:, 1] - ends[:, 0]
    np.add.at(outward, mesh.boundary_elements, np.column_stack([step[:, 1], -step[:, 0]]))
    return outward
