"""Settings of the Krylov solvers: which ones suit, whose word wins, and what is refused."""

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.errors import SolverError
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.scene import Solver
from pearlite_petsc.solver import krylov
from pearlite_petsc.solver.matrix import StiffnessMatrix
from pearlite_petsc.solver.petsc import PETSc
from pearlite_petsc.solver.subdomain import subdomain_of
from tests.solver.bodies import RANDOM, STEEL, options


@pytest.mark.parametrize(
    ("ranks", "unknowns", "packages", "chosen"),
    [
        (1, 5_000, {"suitesparse", "mumps"}, "cholmod"),
        (1, 5_000, {"mumps"}, "mumps"),
        (1, 5_000, set(), None),
        (1, 500_000, {"suitesparse", "mumps"}, "mumps"),
        (2, 5_000, {"suitesparse", "mumps"}, "mumps"),
    ],
)
def test_factors_are_those_of_the_package_that_suits_the_size(
    ranks: int,
    unknowns: int,
    packages: set[str],
    chosen: str | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(krylov, "_has", packages.__contains__)
    settings = krylov.factor_settings(ranks, unknowns)
    assert (settings["ksp_type"], settings["pc_type"]) == ("cg", "cholesky")
    assert settings.get("pc_factor_mat_solver_type") == chosen


def test_factors_on_several_ranks_need_mumps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(krylov, "_has", {"suitesparse"}.__contains__)
    with pytest.raises(SolverError, match="2 ranks: this PETSc has no MUMPS"):
        krylov.factor_settings(2, 5_000)


@pytest.mark.parametrize(
    ("asked", "ranks", "unknowns", "taken"),
    [
        ("auto", 1, 30_000, "factors"),
        ("auto", 1, 30_001, "iterative"),
        ("auto", 2, 3_000, "iterative"),
        ("direct", 1, 3_000, "direct"),
        ("factors", 2, 3_000_000, "factors"),
    ],
)
def test_auto_takes_factors_of_small_matrices_on_one_rank_alone(
    asked: str, ranks: int, unknowns: int, taken: str
) -> None:
    settings = Solver(asked, 1e-9, 100)  # type: ignore[arg-type]
    assert krylov.method_of(settings, ranks, unknowns) == taken


def test_factors_that_repeat_themselves_are_those_of_one_rank_alone() -> None:
    alone = krylov.repeatable_factor_settings(1, 5_000)
    gathered = krylov.repeatable_factor_settings(3, 5_000)
    assert alone["ksp_type"] == gathered["ksp_type"] == "preonly"
    assert gathered["pc_telescope_reduction_factor"] == "3"
    inner = {name.removeprefix("telescope_"): value for name, value in gathered.items()}
    assert alone.items() <= (inner | {"pc_type": gathered["telescope_pc_type"]}).items()


@pytest.fixture
def stiffness() -> StiffnessMatrix:
    subdomain = subdomain_of(RANDOM, spring_stiffness(RANDOM, STEEL), 0, RANDOM.element_count)
    intact = np.zeros(RANDOM.interface_count)
    return StiffnessMatrix(MPI.COMM_SELF, subdomain, subdomain.jump_operator(), intact)


def test_the_users_word_wins_and_our_options_do_not_stay(stiffness: StiffnessMatrix) -> None:
    before = PETSc.Options().getAll()
    with options(ksp_max_it="7", pearlite_ksp_max_it="8", ksp_rtol="1e-3"):
        ksp = krylov.make_solver(stiffness, krylov.multigrid_settings(), 1e-9)
        direct = krylov.make_solver(
            stiffness, krylov.direct_settings(1), 1e-9, krylov.FALLBACK_PREFIX
        )
    assert (ksp.max_it, ksp.rtol, ksp.getType()) == (8, 1e-3, "cg")
    # Plain options are meant for the main solver alone.
    assert direct.rtol == 1e-9
    assert PETSc.Options().getAll() == before
    for item in (ksp, direct, stiffness.mat):
        item.destroy()


def test_smaller_aggregates_make_a_larger_hierarchy(stiffness: StiffnessMatrix) -> None:
    sizes = []
    for finer in (False, True):
        ksp = krylov.make_solver(stiffness, krylov.multigrid_settings(finer), 1e-9)
        pc = ksp.getPC()
        assert krylov.may_coarsen_less(ksp)
        sizes.append(pc.getMGSmoother(pc.getMGLevels() - 2).getOperators()[0].getSize()[0])
        ksp.destroy()
    assert sizes[1] > 2 * sizes[0]
    stiffness.close()


@pytest.mark.parametrize("given", [{"pearlite_pc_type": "nonesuch"}, {"ksp_type": "nonesuch"}])
def test_an_option_that_petsc_does_not_know_is_an_error_of_ours(
    given: dict[str, str], stiffness: StiffnessMatrix
) -> None:
    with options(**given), pytest.raises(SolverError, match="refuses the options of the solver"):
        krylov.make_solver(stiffness, krylov.multigrid_settings(), 1e-9)
    stiffness.close()
