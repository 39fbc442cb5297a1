"""Equilibrium while interfaces break: right answers, fallbacks that are counted, defined ends."""

from dataclasses import replace

import numpy as np
import pytest

from pearlite_petsc.arrays import BoolArray
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.fatigue.loose import LooseClusters
from pearlite_petsc.mechanics import statics
from pearlite_petsc.mechanics.springs import RAJE, spring_stiffness
from pearlite_petsc.scene import Kind, Material
from pearlite_petsc.tessellation.build import build_mesh
from pearlite_petsc.tessellation.mesh import Mesh
from tests.scenes import STATES, default_scene
from tests.solver.bodies import (
    INNER,
    NOTCHED,
    PULL,
    RANDOM,
    STEEL,
    WINDOW,
    equilibrium_of,
    forces,
    none_broken,
    tractions,
)


@pytest.fixture(params=["iterative", "factors"])
def method(request: pytest.FixtureRequest) -> str:
    """Both preconditioners of CG."""
    return str(request.param)


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
        RANDOM, none_broken(RANDOM), method, Material(206e3, nu, RAJE), 1e-5
    )
    assert counters["iterations"] < 400


@pytest.mark.parametrize("nu", [1.0 / 3.0, 0.4])
def test_raje_springs_from_a_third_on_are_refused_by_name(nu: float) -> None:
    with pytest.raises(PearliteError, match=r"'raje': poisson_ratio .* needs poisson_ratio < 1/3"):
        spring_stiffness(RANDOM, Material(206e3, nu, RAJE))


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
