"""Options of one solver: who wins, and that the database is left as it was."""

import pytest

from pearlite_petsc.solver.options import default_options, prefixed_options
from pearlite_petsc.solver.petsc import PETSc
from tests.solver.bodies import options


def inside(plain: bool = True) -> dict[str, str]:
    with prefixed_options("x_", {"ksp_max_it": "1", "pc_type": "none"}, plain):
        return dict(PETSc.Options().getAll())


def test_the_users_prefixed_word_beats_his_plain_one_which_beats_the_default() -> None:
    assert inside()["x_ksp_max_it"] == "1"
    with options(ksp_max_it="2"):
        assert inside()["x_ksp_max_it"] == "2"
        with options(x_ksp_max_it="3"):
            assert inside()["x_ksp_max_it"] == "3"
        assert inside(plain=False)["x_ksp_max_it"] == "1"


def test_plain_options_of_no_solver_are_left_alone() -> None:
    with options(log_view_memory="1", ksp_rtol="1e-3"):
        names = inside().keys()
    assert "x_ksp_rtol" in names and "x_log_view_memory" not in names


def test_options_are_taken_out_again_also_after_an_error() -> None:
    with options(y_pc_type="lu"):
        before = PETSc.Options().getAll()
        with (
            pytest.raises(ZeroDivisionError),
            default_options({"y_pc_type": "none", "y_ksp_type": "cg"}),
        ):
            assert PETSc.Options().getAll()["y_pc_type"] == "lu"
            assert PETSc.Options().getAll()["y_ksp_type"] == "cg"
            raise ZeroDivisionError
        assert PETSc.Options().getAll() == before
