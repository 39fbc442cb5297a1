import numpy as np
from numpy.testing import assert_allclose

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.outcome import Crack, GrowthState
from pearlite_petsc.mechanics.kinematics import (
    jump_operator,
    rigid_modes,
    spring_constants,
    stiffness_blocks,
)
from pearlite_petsc.mechanics.loads import facet_forces, uniform_stress
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.output.element_fields import element_stress, fan, force_moments
from pearlite_petsc.studies.cases import steel
from pearlite_petsc.tessellation.mesh import Mesh
from tests.output import synthetic


def solved(mesh: Mesh, springs: str, stress: tuple[float, float, float]) -> GrowthState:
    """Solve the uncracked window under uniform stress (xx, yy, xy) with a dense matrix."""
    count = 3 * mesh.element_count
    operator = jump_operator(mesh.centre, mesh.interface_elements, mesh.midpoint, mesh.normal, 1.0)
    constants = spring_constants(spring_stiffness(mesh, steel(springs)), mesh.length)
    blocks = stiffness_blocks(operator, constants)
    unknowns = (3 * mesh.interface_elements[:, :, None] + np.arange(3)).reshape(-1, 6)
    matrix = np.zeros((count, count))
    np.add.at(matrix, (unknowns[:, :, None], unknowns[:, None, :]), blocks)
    ends = mesh.vertices[mesh.boundary_vertices]
    load = np.zeros((mesh.element_count, 3))
    facets = facet_forces(
        ends[:, 0], ends[:, 1], mesh.centre[mesh.boundary_elements], uniform_stress(*stress)
    )
    np.add.at(load, mesh.boundary_elements, facets)
    modes = rigid_modes(mesh.centre, 1.0, mesh.centre.mean(axis=0)).reshape(count, 3)
    modes = modes * (np.abs(matrix).max() / np.abs(modes).max() ** 2)
    motion = np.linalg.solve(matrix + modes @ modes.T, load.ravel()).reshape(-1, 3)
    return state_of(mesh, motion)


def state_of(mesh: Mesh, motion: FloatArray) -> GrowthState:
    zero = np.zeros(mesh.interface_count)
    return GrowthState(
        mesh=mesh,
        cycles=0.0,
        crack=Crack(0.0, mesh.notch, np.array([mesh.notch]), 0.0, 0),
        displacement=motion,
        damage=zero,
        normal_stress=zero,
        shear_stress=zero,
        failure_cycles=zero,
        loose=np.zeros(mesh.element_count, dtype=bool),
        solves=1,
    )


def uncracked() -> Mesh:
    """Return a mesh whose notch carries load like everything else."""
    mesh = synthetic.voronoi_mesh()
    values = {name: getattr(mesh, name) for name in mesh.__slots__}
    return Mesh(**{**values, "kind": np.zeros_like(mesh.kind)})


def test_uniform_stress_is_found_in_every_element_but_the_corners() -> None:
    mesh = uncracked()
    state = solved(mesh, "homogeneous", (70.0, 100.0, -30.0))
    stress = element_stress(mesh, state, spring_stiffness(mesh, steel("homogeneous")))
    corner = np.isnan(stress[:, 0, 0])
    assert corner.sum() == 4
    wanted = np.array([[70.0, -30.0], [-30.0, 100.0]])
    assert_allclose(stress[~corner], np.broadcast_to(wanted, stress[~corner].shape), atol=1e-6)


def test_the_moments_of_the_springs_make_the_tensor_symmetric_in_equilibrium() -> None:
    mesh = uncracked()
    springs = spring_stiffness(mesh, steel("raje"))
    state = solved(mesh, "raje", (0.0, 100.0, 0.0))
    moments, resultant = force_moments(mesh, state, springs)
    inner = np.setdiff1d(np.arange(mesh.element_count), mesh.boundary_elements)
    scale = 100.0 * mesh.area.mean()
    assert_allclose(resultant[inner], 0.0, atol=1e-7 * scale)
    asymmetry = moments[inner, 0, 1] - moments[inner, 1, 0]
    assert_allclose(asymmetry, 0.0, atol=1e-7 * scale)
    assert np.abs(state.displacement[:, 2]).max() > 1e-6, "nothing turns, nothing is tested"


def test_a_rigid_motion_carries_no_stress() -> None:
    mesh = uncracked()
    motion = rigid_modes(mesh.centre, 1.0, mesh.centre.mean(axis=0)) @ np.array([0.3, -0.2, 1e-3])
    stress = element_stress(
        mesh, state_of(mesh, motion), spring_stiffness(mesh, steel("homogeneous"))
    )
    assert np.nanmax(np.abs(stress)) < 1e-8


def test_triangles_of_a_polygon_cover_its_area() -> None:
    mesh = synthetic.voronoi_mesh()
    shape = fan(mesh)
    a, b, c = np.swapaxes(shape.points[shape.triangles], 0, 1)
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert area.min() > 0.0
    assert_allclose(np.bincount(shape.owner, weights=area), mesh.area, rtol=1e-12)
    assert np.all(shape.point_owner[shape.triangles] == shape.owner[:, None])
