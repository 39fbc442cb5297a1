"""Equilibrium while interfaces break: right answers, fallbacks that are counted, defined ends."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.errors import PearliteError, SolverError
from pearlite_petsc.fatigue.loose import LooseClusters
from pearlite_petsc.mechanics import statics
from pearlite_petsc.mechanics.loads import uniform_stress
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.scene import Kind, Material, Solver
from pearlite_petsc.solver import equilibrium as equilibrium_module
from pearlite_petsc.solver import krylov, matrix
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.petsc import PETSc
from pearlite_petsc.solver.subdomain import subdomain_of
from pearlite_petsc.studies.bodies import plain_mesh, random_points
from pearlite_petsc.tessellation.build import build_mesh
from pearlite_petsc.tessellation.mesh import Mesh
from tests.scenes import STATES, default_scene

STEEL = Material(206e3, 0.3, "homogeneous")
PULL = uniform_stress(20.0, 100.0, 15.0)
RANDOM = plain_mesh(random_points(900, 60.0, 60.0, seed=5), 60.0, 60.0)
INNER = np.setdiff1d(np.arange(RANDOM.element_count), RANDOM.boundary_elements)
WINDOW = {"width": 60.0, "height": 60.0, "notch": 25.0}
NOTCHED = build_mesh(
    default_scene(window=WINDOW, elements={"refinement": "uniform"}), STATES["undeformed"], 0
)


@pytest.fixture(params=["iterative", "factors"])
def method(request: pytest.FixtureRequest) -> str:
    """Both preconditioners of CG."""
    return str(request.param)


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
    return statics.load_vector(mesh, PULL) * [1.0, 1.0, equilibrium.subdomain.rotation_length]


def tractions(equilibrium: Equilibrium, load: FloatArray) -> FloatArray:
    """Return normal and tangential traction of each interface, as if intact."""
    jump = equilibrium.jumps(equilibrium.solve(load))
    springs = equilibrium.subdomain.stiffness
    return np.stack([springs.k_n * jump[:, 0], springs.k_t * jump[:, 1]], axis=1)


def assert_in_equilibrium(
    mesh: Mesh,
    broken: BoolArray,
    method: str,
    material: Material = STEEL,
    within: float = 1e-6,
) -> dict[str, int]:
    """Compare with a direct solver that shares nothing; return the solver's counters."""
    exact = statics.solve(mesh, spring_stiffness(mesh, material), broken, PULL)
    with equilibrium_of(mesh, broken, material, method=method) as equilibrium:
        found = tractions(equilibrium, forces(mesh, equilibrium))
        counters = dict(equilibrium.counters)
    error = np.abs(found - exact.traction)[~broken].max()
    assert error < within * np.abs(exact.traction).max()
    return counters


def none_broken(mesh: Mesh) -> BoolArray:
    return np.zeros(mesh.interface_count, dtype=bool)


def round_about(mesh: Mesh, elements: list[int]) -> BoolArray:
    """Return which interfaces lie between some elements and all others."""
    inside = np.isin(mesh.interface_elements, elements)
    return np.asarray(inside[:, 0] != inside[:, 1])


def loose_pair(mesh: Mesh) -> BoolArray:
    """Return which interfaces cut off two neighbours in the middle of the body."""
    inner = np.isin(mesh.interface_elements, INNER).all(axis=1)
    middle = np.hypot(*(mesh.midpoint - [30.0, 30.0]).T)
    pair = mesh.interface_elements[np.argmin(np.where(inner, middle, np.inf))]
    return round_about(mesh, pair.tolist())


def test_cracked_body_is_in_the_equilibrium_of_a_direct_solver(method: str) -> None:
    counters = assert_in_equilibrium(NOTCHED, NOTCHED.kind == Kind.NOTCH, method)
    assert not {"multigrid", "refreshed", "direct"} & {*counters}


def test_a_fifth_of_all_interfaces_broken_at_random_still_has_its_equilibrium(method: str) -> None:
    inner = np.isin(RANDOM.interface_elements, INNER).all(axis=1)
    broken = inner & (np.random.default_rng(11).random(RANDOM.interface_count) < 0.2)
    assert not LooseClusters(RANDOM, broken).loose.any()
    counters = assert_in_equilibrium(RANDOM, broken, method)
    assert "direct" not in counters
    assert counters["iterations"] < 150


def test_an_element_with_every_interface_broken_stays_where_it_is(method: str) -> None:
    element = int(INNER[len(INNER) // 2])
    broken = round_about(RANDOM, [element])
    with equilibrium_of(RANDOM, broken, method=method) as equilibrium:
        load = forces(RANDOM, equilibrium)
        assert not load[element].any()
        unknowns = equilibrium.solve(load)
        assert "direct" not in equilibrium.counters
    motion = np.abs(unknowns[:, :2]).max()
    assert 0.0 < motion < 1.0
    assert np.abs(unknowns[element]).max() < 1e-3 * motion


def test_a_loose_pair_leaves_the_others_in_equilibrium(method: str) -> None:
    broken = loose_pair(RANDOM)
    pair = np.flatnonzero(LooseClusters(RANDOM, broken).loose)
    assert len(pair) == 2
    held = broken.copy()
    # The reference has no grounding: it needs one interface to hold the pair, which then hangs
    # from the body as a dead end and carries nothing.
    held[np.flatnonzero(broken)[0]] = False
    exact = statics.solve(RANDOM, spring_stiffness(RANDOM, STEEL), held, PULL)
    with equilibrium_of(RANDOM, broken, method=method) as equilibrium:
        found = tractions(equilibrium, forces(RANDOM, equilibrium))
    error = np.abs(found - exact.traction)[~held & ~broken].max()
    assert error < 1e-5 * np.abs(exact.traction).max()


@pytest.mark.parametrize("nu", [0.0, 0.2, 0.3, 0.33, 0.333])
def test_raje_springs_are_solved_up_to_a_third(nu: float, method: str) -> None:
    counters = assert_in_equilibrium(
        RANDOM, none_broken(RANDOM), method, Material(206e3, nu, "raje"), 1e-5
    )
    assert counters["iterations"] < 400


@pytest.mark.parametrize("nu", [1.0 / 3.0, 0.4])
def test_raje_springs_from_a_third_on_are_refused_by_name(nu: float) -> None:
    with pytest.raises(PearliteError, match=r"'raje': poisson_ratio .* needs poisson_ratio < 1/3"):
        spring_stiffness(RANDOM, Material(206e3, nu, "raje"))


@pytest.mark.parametrize("gamma", [2.0, 10.0, 30.0])
def test_affinely_sheared_mesh_is_solved_or_falls_back_and_says_so(
    gamma: float, method: str
) -> None:
    state = replace(STATES["severe_AT"], shear_strain=gamma)
    mesh = build_mesh(default_scene(window=WINDOW, elements={"shear": "affine"}), state, 0)
    broken = mesh.kind == Kind.NOTCH
    counters = assert_in_equilibrium(mesh, broken, method, within=1e-4)
    assert counters["solves"] == 1
    assert counters.get("direct", 0) <= 1


def test_many_updates_leave_the_matrix_of_a_new_assembly() -> None:
    rng = np.random.default_rng(2)
    subdomain = subdomain_of(RANDOM, spring_stiffness(RANDOM, STEEL), 0, RANDOM.element_count)
    operator, damage = subdomain.jump_operator(), np.zeros(RANDOM.interface_count)
    with matrix.StiffnessMatrix(MPI.COMM_SELF, subdomain, operator, damage) as kept:
        for _ in range(200):
            chosen = rng.integers(0, len(damage), 40)
            damage = damage.copy()
            damage[chosen] = np.minimum(1.0, damage[chosen] + rng.random(40))
            kept.update(damage)
        assert (damage == 1.0).sum() > 1000
        with matrix.StiffnessMatrix(MPI.COMM_SELF, subdomain, operator, damage) as fresh:
            assert np.array_equal(kept.mat.getValuesCSR()[2], fresh.mat.getValuesCSR()[2])


def test_broken_interfaces_add_nothing_and_leave_the_ground_and_three_supports() -> None:
    subdomain = subdomain_of(RANDOM, spring_stiffness(RANDOM, STEEL), 0, RANDOM.element_count)
    broken, held = np.ones(RANDOM.interface_count), []
    for damage in (broken, 0.0 * broken):
        with matrix.StiffnessMatrix(
            MPI.COMM_SELF, subdomain, subdomain.jump_operator(), damage
        ) as stiffness:
            offsets, columns, values = stiffness.mat.getValuesCSR()
            rows = np.repeat(np.arange(3 * subdomain.owned_count), np.diff(offsets))
            if damage.any():
                assert not values[rows != columns].any()
            held.append(values[rows == columns].reshape(-1, 3))
    share = held[0] / held[1].mean(axis=1, keepdims=True)
    supports = np.argwhere(share > 0.5 * matrix.SUPPORT)
    x, y = RANDOM.centre.T
    left, right = np.argmin(x + y), np.argmin(y - x)
    assert sorted(supports.tolist()) == sorted([[left, 0], [left, 1], [right, 1]])
    assert share[tuple(supports.T)] == pytest.approx(matrix.SUPPORT, rel=0.01)
    share[tuple(supports.T)] = matrix.GROUNDING
    assert share == pytest.approx(matrix.GROUNDING, rel=0.01)


def test_many_iterations_let_the_hierarchies_that_follow_coarsen_less_also_when_restored() -> None:
    material = Material(206e3, 0.333, "raje")
    broken = none_broken(RANDOM)
    with equilibrium_of(RANDOM, broken, material, tolerance=1e-9) as equilibrium:
        load = forces(RANDOM, equilibrium)
        iterations = []
        for times in (1.0, -1.0):
            before, early = equilibrium.counters["iterations"], equilibrium.state()
            found = equilibrium.solve(times * load)
            iterations.append(equilibrium.counters["iterations"] - before)
        assert equilibrium.counters["finer"] == 1
        assert equilibrium.counters["setups"] == 2
        assert iterations[1] < 0.9 * iterations[0]
        memory = equilibrium.state()
        wanted = equilibrium.solve(1.1 * load)
        assert equilibrium.counters["setups"] == 2
    for remembered, times, solution in ((memory, 1.1, wanted), (early, -1.0, found)):
        with equilibrium_of(RANDOM, broken, material, tolerance=1e-9) as again:
            again.restore(remembered)
            assert np.array_equal(again.solve(times * load), solution)


def test_who_chooses_the_aggregates_or_no_multigrid_keeps_them() -> None:
    material = Material(206e3, 0.333, "raje")
    for given in ({"pc_gamg_square_graph": "1"}, {"pearlite_pc_type": "jacobi"}):
        with (
            options(**given),
            equilibrium_of(RANDOM, none_broken(RANDOM), material, tolerance=1e-6) as equilibrium,
        ):
            load = forces(RANDOM, equilibrium)
            equilibrium.solve(load)
            assert equilibrium.counters["iterations"] > 30
            equilibrium.solve(-load)
            assert equilibrium.counters["finer"] == 0


def test_old_factors_that_no_longer_converge_are_refreshed_and_counted() -> None:
    broken = NOTCHED.kind == Kind.NOTCH
    with (
        options(pearlite_ksp_max_it="2"),
        equilibrium_of(NOTCHED, broken, method="factors") as equilibrium,
    ):
        load = forces(NOTCHED, equilibrium)
        equilibrium.solve(load)
        assert not {"refreshed", "direct"} & {*equilibrium.counters}
        ahead = np.hypot(*(NOTCHED.midpoint - NOTCHED.notch).T) < 6.0
        damage = np.where(ahead, 0.9, broken)
        equilibrium.update(damage)
        equilibrium.solve(load)
        assert equilibrium.counters["refreshed"] == 1
        assert "direct" not in equilibrium.counters


def test_multigrid_that_does_not_converge_is_refreshed_then_replaced_by_a_direct_solver() -> None:
    broken = NOTCHED.kind == Kind.NOTCH
    exact = statics.solve(NOTCHED, spring_stiffness(NOTCHED, STEEL), broken, PULL)
    with options(pearlite_ksp_max_it="1"), equilibrium_of(NOTCHED, none_broken(NOTCHED)) as solver:
        load = forces(NOTCHED, solver)
        solver.update(broken.astype(float))
        found = tractions(solver, load)
        assert (solver.counters["refreshed"], solver.counters["direct"]) == (1, 1)
        solver.solve(-load)
        assert (solver.counters["refreshed"], solver.counters["direct"]) == (1, 2)
    error = np.abs(found - exact.traction)[~broken].max()
    assert error < 1e-6 * np.abs(exact.traction).max()


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


def test_factors_that_cannot_be_made_are_replaced_by_multigrid_and_counted() -> None:
    broken = NOTCHED.kind == Kind.NOTCH
    with (
        options(pearlite_pc_factor_mat_solver_type="absent"),
        equilibrium_of(NOTCHED, broken, method="factors") as equilibrium,
    ):
        assert equilibrium.counters["multigrid"] == 1
        equilibrium.solve(forces(NOTCHED, equilibrium))
        assert "direct" not in equilibrium.counters


def test_when_the_direct_solver_fails_too_the_error_names_residual_and_limit() -> None:
    useless = {"pearlite_ksp_max_it": "1", "pearlite_direct_pc_type": "none"}
    with options(**useless), equilibrium_of(NOTCHED, NOTCHED.kind == Kind.NOTCH) as equilibrium:
        with pytest.raises(
            SolverError, match=r"direct solver: .*relative residual .* against 1e-06"
        ):
            equilibrium.solve(forces(NOTCHED, equilibrium))
        assert equilibrium.counters["direct"] == 1


def test_an_old_hierarchy_whose_finest_smoother_sees_the_breaks_goes_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(equilibrium_module, "setup_cost", lambda _: 1e9)
    damage = (NOTCHED.kind == Kind.NOTCH).astype(float)
    ahead = NOTCHED.midpoint - NOTCHED.notch
    level = (ahead[:, 0] > 0.0) & (np.abs(NOTCHED.normal[:, 1]) > 0.7) & (damage < 1.0)
    order = np.argsort(np.where(level, ahead[:, 0] + 4.0 * np.abs(ahead[:, 1]), np.inf))
    with (
        options(pearlite_pc_mg_type="multiplicative"),
        equilibrium_of(NOTCHED, damage == 1.0, tolerance=1e-6) as equilibrium,
    ):
        load = forces(NOTCHED, equilibrium)
        equilibrium.solve(load)
        before = equilibrium.counters["iterations"]
        for interface in order[:8]:
            damage = damage.copy()
            damage[interface] = 1.0
            equilibrium.update(damage)
            equilibrium.solve(load)
        assert equilibrium.counters["setups"] == 1
        assert not {"refreshed", "direct"} & {*equilibrium.counters}
        # From the last solution, and yet not less than from zero: a smoother that does not see the
        # breaks needs a quarter more.
        assert equilibrium.counters["iterations"] - before <= 8 * before
