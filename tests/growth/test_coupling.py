"""What couples the interfaces that soften together, against solves of the whole body."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.fatigue.damage_state import notched
from pearlite_petsc.fatigue.softening import Softening
from pearlite_petsc.growth.body import CrackedBody
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.coupling import LEAST_GAIN, MOST_COUPLED
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.scene import Kind
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0},
    elements={"width": 3.0, "length": 6.0},
    solver={"relative_tolerance": 1e-11},
)
CASE = CrackCase(SCENE, STATES["severe_AT"], 18e3)
PREPARED = prepare_growth(SCENE, CASE.state, 0)
MESH = PREPARED.mesh
START = notched(MESH.kind)
GAP = np.where(MESH.kind == Kind.NOTCH, np.inf, np.hypot(*(MESH.midpoint - MESH.notch).T))
NEAR = np.sort(np.argsort(GAP)[:5])


def body_of(method: str = "factors") -> CrackedBody:
    scene = replace(SCENE, solver=replace(SCENE.solver, method=method))
    domain = Domain(MPI.COMM_SELF, scene, MESH, PREPARED.ratio)
    return CrackedBody(domain, replace(CASE, scene=scene), START.damage)


def softening_of(body: CrackedBody, damage: np.ndarray, numbers: np.ndarray) -> tuple:
    """Return the interfaces that soften together, and the jumps of all at the damage."""
    jump = body.solve(damage)
    return softening_with(body, damage, numbers, jump), jump


def softening_with(
    body: CrackedBody, damage: np.ndarray, numbers: np.ndarray, jump: np.ndarray
) -> Softening:
    start = body.situation(replace(START, damage=damage).solved(jump))
    limits = np.ones(len(damage))
    return start.coupling.softening(numbers, start.drive, jump, start.stiffness_ratio, limits)


def test_only_what_gains_much_counts_as_softening_and_not_too_many() -> None:
    body = body_of()
    gain = np.zeros(MESH.interface_count)
    gain[NEAR] = [0.5, 2.0 * LEAST_GAIN, 0.9 * LEAST_GAIN, 0.3, 1.0]
    assert body.coupling.softening_interfaces(gain).tolist() == NEAR[[0, 1, 3, 4]].tolist()
    gain = np.linspace(0.5, 1.0, MESH.interface_count)
    most = body.coupling.softening_interfaces(gain)
    assert most.tolist() == list(range(MESH.interface_count))[-MOST_COUPLED:]
    body.domain.close()


def test_values_of_some_interfaces_are_read_and_replaced() -> None:
    body = body_of()
    values = np.random.default_rng(1).uniform(size=(MESH.interface_count, 3))
    assert np.array_equal(body.coupling.values_of(NEAR, values), values[NEAR])
    new = body.coupling.with_values(NEAR, values, np.zeros((5, 3)))
    assert not new[NEAR].any() and values[NEAR].all()
    others = np.setdiff1d(np.arange(len(values)), NEAR)
    assert np.array_equal(new[others], values[others])
    body.domain.close()


@pytest.mark.parametrize("method", ["factors", "iterative"])
def test_jumps_foreseen_at_another_damage_are_those_of_a_solve(method: str) -> None:
    body = body_of(method)
    # None of them lengthens the crack, so that the load stays where it is.
    inner = [number for number in np.argsort(GAP)[:40] if _lengthens(body, number) == 0.0]
    numbers = np.sort(np.array(inner[:4]))
    first, _ = softening_of(body, START.damage, numbers)
    damage = START.damage.copy()
    damage[numbers] = [0.3, 0.9, 0.6, 0.2]
    exact = body.solve(damage)[numbers]
    found = first.jumps_at(damage[numbers])
    assert np.abs(found - exact).max() < 1e-5 * np.abs(exact).max()
    # The same from factors of an earlier damage.
    second, jump = softening_of(body, damage, numbers)
    further = damage.copy()
    further[numbers] += 0.05
    exact = body.solve(further)[numbers]
    assert np.abs(second.jumps_at(further[numbers]) - exact).max() < 1e-5 * np.abs(exact).max()
    assert np.abs(jump[numbers] - found).max() < 1e-5 * np.abs(found).max()
    body.domain.close()


def _lengthens(body: CrackedBody, number: int) -> float:
    own = body.domain.subdomain.interfaces
    interface = own.elements[number], own.junctions[number], own.ends[number]
    x, _ = body.tracker.tip_after(tuple(each.tolist() for each in interface))
    return float(x - body.tracker.tip[0])


def test_the_pull_of_a_load_that_follows_the_tip_is_foreseen() -> None:
    body = body_of()
    number = max(np.argsort(GAP)[:12], key=lambda each: _lengthens(body, each))
    numbers = np.array([number])
    foreseen, _ = softening_of(body, START.damage, numbers)
    assert foreseen.load.advance[0, 0] > 0.0
    damage = START.damage.copy()
    damage[number] = 0.6
    exact = body.solve(damage)[numbers]
    found = foreseen.jumps_at(damage[numbers])
    fixed = replace(foreseen.load, advance=np.zeros((1, 2)))
    still = replace(foreseen, load=fixed).jumps_at(damage[numbers])
    assert np.abs(found - exact).max() < 0.01 * np.abs(exact).max()
    assert np.abs(still - exact).max() > 3.0 * np.abs(found - exact).max()
    body.domain.close()


def test_a_restored_coupling_foresees_the_same_bits() -> None:
    one, other = body_of(), body_of()
    softening_of(one, START.damage, NEAR[:3])
    damage = START.damage.copy()
    damage[NEAR] = 0.2
    softening_of(one, damage, NEAR)
    state = one.coupling.state()
    assert state is not None and state.batch.max() >= 1
    other.domain.equilibrium.restore(one.domain.equilibrium.state())
    other.coupling.restore(state)
    again = other.coupling.state()
    assert again is not None and again.pull_tip == state.pull_tip
    assert again.numbers.tolist() == state.numbers.tolist()
    further = damage.copy()
    further[NEAR] = 0.5
    jump = one.solve(further)
    found = [softening_with(body, further, NEAR, jump) for body in (one, other)]
    assert np.array_equal(found[0].compliance, found[1].compliance)
    assert np.array_equal(found[0].load.pull, found[1].load.pull)
    one.domain.close()
    other.domain.close()


def test_nothing_is_saved_before_the_first_block() -> None:
    body = body_of()
    assert body.coupling.state() is None
    body.domain.close()
