"""A crack whose solver gives up time and again is still the same crack, and says what it took."""

from collections.abc import Iterator

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.errors import SolverError
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.solver.petsc import PETSc
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0},
    elements={"width": 3.0, "length": 6.0},
    loading={"extension": 10.0},
    solver={"relative_tolerance": 1e-9},
)
STATE = STATES["severe_AT"]
PREPARED = prepare_growth(SCENE, STATE, 0)


@pytest.fixture
def one_iteration() -> Iterator[None]:
    """CG may take one iteration, which never is enough for multigrid."""
    options = PETSc.Options()
    options.setValue("pearlite_ksp_max_it", "1")
    yield
    options.delValue("pearlite_ksp_max_it")


def grown() -> Outcome:
    outcome = CrackGrowth(MPI.COMM_SELF, SCENE, STATE, 20e3, PREPARED).grown()
    assert outcome is not None
    return outcome


def test_solves_by_the_direct_solver_are_counted_and_the_crack_stays_the_same(
    request: pytest.FixtureRequest,
) -> None:
    undisturbed = grown()
    assert (
        undisturbed.effort.counters.get("direct", 0)
        == undisturbed.effort.counters.get("refreshed", 0)
        == 0
    )
    request.getfixturevalue("one_iteration")
    fallen_back = grown()
    assert fallen_back.effort.counters["direct"] > 0.8 * fallen_back.effort.solves
    assert np.array_equal(fallen_back.shape.broken_pairs, undisturbed.shape.broken_pairs)
    assert fallen_back.da_dn == pytest.approx(undisturbed.da_dn, rel=1e-6)


@pytest.mark.usefixtures("one_iteration")
def test_error_of_a_task_that_no_solver_can_do_names_cycle_length_and_reason() -> None:
    options = PETSc.Options()
    options.setValue("pearlite_direct_pc_type", "none")
    try:
        with pytest.raises(
            SolverError, match=r"^at N = 0 cycles, a = 2\d\.\d\d um: direct solver: "
        ):
            grown()
    finally:
        options.delValue("pearlite_direct_pc_type")
