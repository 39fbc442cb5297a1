"""Bodies of the solver's tests, and what puts them into equilibrium."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.mechanics import statics
from pearlite_petsc.mechanics.loads import uniform_stress
from pearlite_petsc.mechanics.springs import HOMOGENEOUS, spring_stiffness
from pearlite_petsc.scene import Material, Solver
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.petsc import PETSc
from pearlite_petsc.solver.subdomain import subdomain_of
from pearlite_petsc.studies.bodies import plain_mesh, random_points
from pearlite_petsc.tessellation.build import build_mesh
from pearlite_petsc.tessellation.mesh import Mesh
from tests.scenes import STATES, default_scene

STEEL = Material(206e3, 0.3, HOMOGENEOUS)
PULL = uniform_stress(20.0, 100.0, 15.0)
RANDOM = plain_mesh(random_points(900, 60.0, 60.0, seed=5), 60.0, 60.0)
INNER = np.setdiff1d(np.arange(RANDOM.element_count), RANDOM.boundary_elements)
WINDOW = {"width": 60.0, "height": 60.0, "notch": 25.0}
NOTCHED = build_mesh(
    default_scene(window=WINDOW, elements={"refinement": "uniform"}), STATES["undeformed"], 0
)


@contextmanager
def equilibrium_of(
    mesh: Mesh,
    broken: BoolArray,
    material: Material = STEEL,
    tolerance: float = 1e-10,
    method: str = "iterative",
) -> Iterator[Equilibrium]:
    subdomain = subdomain_of(mesh, spring_stiffness(mesh, material), 0, mesh.element_count)
    settings = Solver(method, tolerance, 1000)  # type: ignore[arg-type]
    with Equilibrium(MPI.COMM_SELF, subdomain, broken.astype(float), settings) as equilibrium:
        yield equilibrium


@contextmanager
def options(**given: str) -> Iterator[None]:
    """Put PETSc options into the database, as a user's command line does."""
    database = PETSc.Options()
    for name, value in given.items():
        database.setValue(name, value)
    try:
        yield
    finally:
        for name in given:
            database.delValue(name)


def forces(mesh: Mesh, equilibrium: Equilibrium) -> FloatArray:
    """Return (F_x, F_y, M) of the pull on the boundary."""
    return statics.load_vector(mesh, PULL) * [
        1.0,
        1.0,
        equilibrium.system.subdomain.rotation_length,
    ]


def tractions(equilibrium: Equilibrium, load: FloatArray) -> FloatArray:
    """Return normal and tangential traction of each interface, as if intact."""
    jump = equilibrium.jumps(equilibrium.solve(load))
    springs = equilibrium.system.subdomain.interfaces.stiffness
    return np.stack([springs.k_n * jump[:, 0], springs.k_t * jump[:, 1]], axis=1)


def none_broken(mesh: Mesh) -> BoolArray:
    return np.zeros(mesh.interface_count, dtype=bool)
