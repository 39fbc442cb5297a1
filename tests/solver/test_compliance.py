"""The compliance of a few interfaces against dense algebra, at damages the factors do not know."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI
from scipy.sparse import csr_array

from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.load import TipLoad
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.scene import Kind
from pearlite_petsc.solver.compliance import Compliance
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0}, elements={"width": 3.0, "length": 6.0}
)
PREPARED = prepare_growth(SCENE, STATES["undeformed"], 0)


NOTCHED = (PREPARED.mesh.kind == Kind.NOTCH).astype(float)


def load_on(domain: Domain) -> np.ndarray:
    case = CrackCase(SCENE, STATES["undeformed"], 12e3)
    return TipLoad(case, domain.subdomain).at(PREPARED.mesh.notch)


def domain_of(method: str = "iterative") -> Domain:
    solver = replace(SCENE.solver, method=method)  # type: ignore[arg-type]
    return Domain(MPI.COMM_SELF, replace(SCENE, solver=solver), PREPARED.mesh, PREPARED.ratio)


def near_the_notch(domain: Domain, count: int) -> np.ndarray:
    own = domain.subdomain.interfaces
    gap = np.hypot(*(own.midpoint - PREPARED.mesh.notch).T)
    gap[own.kind == Kind.NOTCH] = np.inf
    return np.sort(np.argsort(gap)[:count])


def dense(domain: Domain) -> tuple[np.ndarray, np.ndarray]:
    """Return the matrix of now and the rows B of all interfaces."""
    subdomain, operator = domain.subdomain, domain.equilibrium.system.operator
    rows = np.zeros((len(operator), 3, 3 * subdomain.owned_count))
    for number, pair in enumerate(subdomain.interfaces.elements):
        rows[number][:, (3 * pair[:, None] + np.arange(3)).ravel()] = operator[number]
    offsets, columns, values = domain.equilibrium.system.matrix.mat.getValuesCSR()
    return csr_array((values, columns, offsets)).toarray(), rows


@pytest.mark.parametrize("method", ["iterative", "factors"])
def test_compliance_and_response_are_those_of_dense_algebra(method: str) -> None:
    domain = domain_of(method)
    chosen = near_the_notch(domain, 6)
    compliance = Compliance(domain.equilibrium, NOTCHED)
    compliance.add(chosen[[1, 3]])
    compliance.add(chosen)
    assert sorted(compliance.numbers.tolist()) == chosen.tolist()
    assert compliance.numbers[:2].tolist() == chosen[[1, 3]].tolist()
    damage = NOTCHED.copy()
    damage[chosen] = [1.0, 0.6, 0.0, 0.3, 0.9, 0.05]
    load = load_on(domain)
    response = compliance.response([load])
    found, pulled = compliance.at(chosen[1:4], damage, response)
    domain.equilibrium.update(damage)
    matrix, rows = dense(domain)
    some = rows[chosen[1:4]].reshape(9, -1)
    exact = some @ np.linalg.solve(matrix, some.T)
    assert np.abs(found - exact).max() < 1e-7 * np.abs(exact).max()
    assert np.array_equal(found.shape, (9, 9))
    scaled = load.copy()
    scaled[:, 2] /= domain.subdomain.rotation_length
    jumps = (some @ np.linalg.solve(matrix, scaled.ravel())).reshape(3, 3)
    assert np.abs(pulled[:, :, 0] - jumps).max() < 1e-6 * np.abs(jumps).max()
    domain.close()


def test_what_is_taken_in_the_same_batches_has_the_same_bits() -> None:
    domain = domain_of("factors")
    chosen = near_the_notch(domain, 5)
    empty = np.empty((len(NOTCHED), 3, 0))
    found = []
    for _ in range(2):
        compliance = Compliance(domain.equilibrium, NOTCHED)
        compliance.add(chosen[:3])
        compliance.add(chosen)
        assert compliance.batch.tolist() == [0, 0, 0, 1, 1]
        found.append(compliance.at(chosen, NOTCHED, empty)[0])
    assert np.array_equal(*found)
    compliance = Compliance(domain.equilibrium, NOTCHED)
    compliance.add(chosen)
    at_once, _ = compliance.at(chosen, NOTCHED, empty)
    assert np.abs(at_once - found[0]).max() < 1e-9 * np.abs(at_once).max()
    assert np.abs(at_once - at_once.T).max() < 1e-9 * np.abs(at_once).max()
    domain.close()


def test_factors_corrected_for_what_was_taken_solve_at_once() -> None:
    domain = domain_of("factors")
    equilibrium, chosen = domain.equilibrium, near_the_notch(domain, 6)
    load = load_on(domain)
    equilibrium.solve(load)
    Compliance(domain.equilibrium, NOTCHED).add(chosen)
    damage = NOTCHED.copy()
    damage[chosen] = [1.0, 0.6, 0.2, 0.3, 0.9, 0.05]
    equilibrium.update(damage)
    before = equilibrium.counters["iterations"]
    unknowns = equilibrium.solve(load)[: domain.subdomain.owned_count].ravel()
    assert equilibrium.counters["iterations"] - before <= 2
    matrix, _ = dense(domain)
    scaled = load.copy()
    scaled[:, 2] /= domain.subdomain.rotation_length
    assert np.linalg.norm(matrix @ unknowns - scaled.ravel()) < 1e-8 * np.linalg.norm(scaled)
    domain.close()


def test_large_bodies_are_solved_for_in_small_batches(monkeypatch: pytest.MonkeyPatch) -> None:
    domain = domain_of("factors")
    chosen = near_the_notch(domain, 5)
    compliance = Compliance(domain.equilibrium, NOTCHED)
    empty = np.empty((len(NOTCHED), 3, 0))
    compliance.add(chosen)
    at_once, _ = compliance.at(chosen, NOTCHED, empty)
    compliance = Compliance(domain.equilibrium, NOTCHED)
    monkeypatch.setattr(
        "pearlite_petsc.solver.compliance.MOST_AT_ONCE", 18 * domain.subdomain.element_count
    )
    compliance.add(chosen)
    assert compliance.batch.tolist() == [0, 0, 1, 1, 2]
    in_batches, _ = compliance.at(chosen, NOTCHED, empty)
    assert np.abs(in_batches - at_once).max() < 1e-9 * np.abs(at_once).max()
    domain.close()


def test_compliance_is_outdated_once_the_preconditioner_has_newer_factors() -> None:
    domain = domain_of("factors")
    chosen = near_the_notch(domain, 3)
    first = Compliance(domain.equilibrium, NOTCHED)
    first.add(chosen)
    assert not first.is_outdated
    damage = NOTCHED.copy()
    damage[chosen] = 0.5
    second = Compliance(domain.equilibrium, damage)
    assert first.is_outdated and not second.is_outdated
    assert np.array_equal(second.set_up_damage, damage) and not len(second.numbers)
    domain.close()


@pytest.mark.parametrize("method", ["iterative", "factors"])
def test_factors_of_the_start_are_kept_for_the_next_crack_of_a_mesh(method: str) -> None:
    solver = replace(SCENE.solver, method=method)  # type: ignore[arg-type]
    scene = replace(SCENE, solver=solver)
    domain = Domain(MPI.COMM_SELF, scene, PREPARED.mesh, PREPARED.ratio, keep_first=True)
    equilibrium = domain.equilibrium
    first = equilibrium.factors(NOTCHED)
    domain.rewind()
    assert equilibrium.factors(NOTCHED).number == first.number
    # Equal values, and another array.
    assert equilibrium.factors(NOTCHED.copy()).number == first.number
    softened = equilibrium.factors(
        np.where(domain.subdomain.interfaces.kind == Kind.NOTCH, 1.0, 0.1)
    )
    assert softened.number > first.number
    assert equilibrium.holds(softened) and not equilibrium.holds(first)
    domain.rewind()
    again = equilibrium.factors(NOTCHED)
    assert np.array_equal(again.damage, NOTCHED)
    assert (again.number == first.number) == (method == "factors")
    domain.close()


def test_a_softened_interface_of_one_crack_corrects_nothing_in_the_next() -> None:
    solver = replace(SCENE.solver, method="factors")
    scene = replace(SCENE, solver=solver)
    domain = Domain(MPI.COMM_SELF, scene, PREPARED.mesh, PREPARED.ratio, keep_first=True)
    Compliance(domain.equilibrium, NOTCHED).add(near_the_notch(domain, 2))
    factors = domain.equilibrium.factors(NOTCHED)
    assert factors.woodbury is not None
    domain.rewind()
    assert domain.equilibrium.factors(NOTCHED) is factors and factors.woodbury is None
    domain.close()
