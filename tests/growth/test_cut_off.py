"""A crack that cuts off a loaded piece of the window ends with an error that says where and when."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.errors import SolverError
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import Prepared, prepare_growth
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.mesh import Mesh
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0},
    elements={"refinement": "uniform"},
    loading={"extension": 15.0},
)
STATE = STATES["undeformed"]


def with_a_corner_on_one_interface(mesh: Mesh) -> tuple[Mesh, set[int]]:
    """Return the mesh with its upper right corner held by one interface alone, and that corner."""
    corner = np.flatnonzero(np.hypot(*(mesh.centre - [60.0, 60.0]).T) < 12.0)
    inside = np.isin(mesh.interface_elements, corner)
    ring = np.flatnonzero(inside[:, 0] != inside[:, 1])
    kind = mesh.kind.copy()
    kind[ring[1:]] = Kind.NOTCH
    return replace(mesh, kind=kind), set(corner.tolist())


def growth_of(prepared: Prepared, mesh: Mesh) -> CrackGrowth:
    return CrackGrowth(MPI.COMM_SELF, SCENE, STATE, 20e3, replace(prepared, mesh=mesh))


def test_cluster_cut_off_with_boundary_load_is_an_error_with_element_cycle_and_crack_length() -> (
    None
):
    prepared = prepare_growth(SCENE, STATE, 0)
    mesh, corner = with_a_corner_on_one_interface(prepared.mesh)
    growth = growth_of(prepared, mesh)
    with pytest.raises(SolverError) as raised:
        list(growth.steps())
    growth.close()
    message = str(raised.value)
    assert message.startswith(f"at N = {growth.cycles:.6g} cycles, a = ")
    assert growth.cycles > 0.0
    assert f"a cluster of {len(corner)} elements about element " in message
    assert int(message.split("about element ")[1].split()[0]) in corner
    assert "carries boundary load" in message


def test_element_cut_off_without_load_is_counted_and_the_crack_grows_on() -> None:
    prepared = prepare_growth(SCENE, STATE, 0)
    mesh = prepared.mesh
    element = int(np.argmin(np.hypot(*(mesh.centre - [48.0, 48.0]).T)))
    kind = mesh.kind.copy()
    kind[(mesh.interface_elements == element).any(axis=1)] = Kind.NOTCH
    growth = growth_of(prepared, replace(mesh, kind=kind))
    outcome = growth.grown()
    assert outcome is not None
    assert outcome.effort.counters["loose_elements"] >= 1
    assert outcome.da_dn > 0.0
    assert outcome.effort.counters.get("direct", 0) == 0
