"""The solvers that bench solver compares: all reach the tolerance, first and after breaks."""

from contextlib import closing

import numpy as np
import pytest

pytest.importorskip("petsc4py")
from mpi4py import MPI

from pearlite_petsc.scene import Kind
from pearlite_petsc.studies.benchmarks.solver import METHODS
from pearlite_petsc.studies.benchmarks.solver_bodies import Body, read_body, write_bodies
from pearlite_petsc.studies.benchmarks.solver_case import measure
from pearlite_petsc.studies.benchmarks.solver_methods import (
    FIRST_TOLERANCE,
    WARM_TOLERANCE,
    method_of,
    missing,
)


@pytest.fixture(scope="module")
def body(tmp_path_factory: pytest.TempPathFactory) -> Body:
    folder = tmp_path_factory.mktemp("bodies")
    assert write_bodies(folder, 1500.0, (1,)) == pytest.approx(1500, rel=0.2)
    return read_body(folder, 1, 0)


@pytest.mark.parametrize("name", METHODS)
def test_a_method_solves_from_zero_and_goes_on_after_breaks(name: str, body: Body) -> None:
    if why := missing(name):
        pytest.skip(why)
    here, load = body.subdomain, body.load()
    damage = (here.interfaces.kind == Kind.NOTCH).astype(float)
    with closing(method_of(MPI.COMM_SELF, here, damage, name)) as solver:
        solver.set_up()
        iterations = solver.first_solve(load)
        assert 0 < iterations < 100
        assert 0.0 < solver.residual() <= FIRST_TOLERANCE
        solver.begin_warm(load)
        for number in body.breaks:
            damage = np.where(here.interfaces.numbers == number, 1.0, damage)
            solver.update(damage)
            solver.prepare()
            assert 0 < solver.warm_solve(load) < 100
            assert 0.0 < solver.residual() <= 1.01 * WARM_TOLERANCE


def test_what_is_measured_holds_for_the_cracked_body_too(body: Body) -> None:
    intact, cracked = (measure(MPI.COMM_SELF, body, "factors", crack) for crack in (False, True))
    for row in (intact, cracked):
        assert row["unknowns"] == 3 * body.subdomain.element_count
        assert row["iterations"] == 1
        assert row["residual"] <= FIRST_TOLERANCE
        assert row["solution_s"] == pytest.approx(row["setup_s"] + row["first_solve_s"])
        assert row["warm_iterations"] >= 1
