"""A mesh with its crack: what drives it, what a break does, and what it would do."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.errors import SolverError
from pearlite_petsc.fatigue.damage_state import notched
from pearlite_petsc.growth.body import CrackedBody
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.scene import Kind
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0},
    elements={"width": 3.0, "length": 6.0},
    solver={"relative_tolerance": 1e-10},
)
CASE = CrackCase(SCENE, STATES["severe_AT"], 18e3)
PREPARED = prepare_growth(SCENE, CASE.state, 0)
MESH = PREPARED.mesh
START = notched(MESH.kind)
GAP = np.where(MESH.kind == Kind.NOTCH, np.inf, np.hypot(*(MESH.midpoint - MESH.notch).T))


def body_of(case: CrackCase = CASE) -> CrackedBody:
    domain = Domain(MPI.COMM_SELF, SCENE, MESH, PREPARED.ratio)
    return CrackedBody(domain, case, START.damage)


def test_a_situation_has_the_law_and_stresses_of_the_interfaces() -> None:
    body = body_of()
    jump = body.solve(START.damage)
    start = body.situation(START.solved(jump))
    drive = start.drive
    intact = MESH.kind != Kind.NOTCH
    assert drive.normal[intact] == pytest.approx((start.stiffness.k_n * jump[:, 0])[intact])
    assert not drive.normal[~intact].any() and not drive.shear[~intact].any()
    rate = drive.rate_at(START.damage)
    # Coarse elements take no damage; the tip's interfaces do.
    assert not rate[~body.domain.subdomain.interfaces.fine].any()
    assert rate[np.argsort(GAP)[:6]].max() > 0.0
    assert start.failure_damage == 1.0 and start.least(3.0) == start.greatest(3.0) == 3.0
    body.domain.close()


def test_nominal_stress_breaks_at_the_failure_damage_of_the_scene() -> None:
    damage = replace(SCENE.damage, stress="nominal", failure_damage=0.7)
    body = body_of(replace(CASE, scene=replace(SCENE, damage=damage)))
    start = body.situation(START.solved(np.zeros((MESH.interface_count, 3))))
    assert start.nominal and start.failure_damage == 0.7
    body.domain.close()


def test_breaks_reach_what_was_foreseen_and_move_the_tip() -> None:
    body = body_of()
    ahead = np.argsort(GAP)[:8]
    broken = body.domain.edges(np.sort(ahead))
    tip = body.tracker.tip
    foreseen = body.reached_by(broken)
    assert body.tracker.tip == tip
    reached = body.lengthen(broken)
    assert sorted(set(foreseen)) == sorted(set(reached)) and reached
    assert body.tracker.tip[0] == max(x for x, _ in reached) > tip[0]
    assert body.tracker.broken == 8
    body.domain.close()


def test_a_crack_taken_up_from_broken_interfaces_is_the_one_that_grew() -> None:
    grown = body_of()
    ahead = np.argsort(GAP)[:8]
    grown.lengthen(grown.domain.edges(np.sort(ahead)))
    damage = START.damage.copy()
    damage[ahead] = 1.0
    domain = Domain(MPI.COMM_SELF, SCENE, MESH, PREPARED.ratio, damage)
    begun = CrackedBody(domain, CASE, damage)
    assert begun.tracker.tip == grown.tracker.tip
    assert begun.tracker.broken == grown.tracker.broken
    grown.domain.close()
    domain.close()


def test_the_front_is_the_tip_and_what_is_damaged_but_whole() -> None:
    body = body_of()
    damage = START.damage.copy()
    damage[[3, 4, 5]] = [0.04, 0.06, 1.0]
    front = body.front(damage)
    assert front.tolist() == [MESH.midpoint[4].tolist(), list(body.tracker.tip)]
    body.domain.close()


def test_only_what_lies_near_a_break_is_disturbed() -> None:
    body = body_of()
    number = int(np.argmin(GAP))
    near = body.near(body.domain.edges(np.array([number])))
    gap = np.hypot(*(MESH.midpoint - body.domain.subdomain.interfaces.ends[number].mean(axis=0)).T)
    assert near[number] and near.sum() > 5
    assert gap[near].max() < 12.0 <= gap[~near].min()
    nothing = body.near(body.domain.edges(np.empty(0, dtype=np.int64)))
    assert not nothing.any()
    body.domain.close()


def test_cutting_off_a_loaded_corner_is_foreseen_as_an_error_and_an_inner_element_is_loose() -> (
    None
):
    body = body_of()
    corner = int(np.argmin(np.hypot(*(MESH.centre - [60.0, 60.0]).T)))
    ring = np.flatnonzero((MESH.interface_elements == corner).any(axis=1))
    with pytest.raises(SolverError, match=f"element {corner} .*carries boundary load"):
        body.check_attached(body.domain.edges(ring))
    inner = np.setdiff1d(np.arange(MESH.element_count), MESH.boundary_elements)
    element = int(inner[np.argmin(np.hypot(*(MESH.centre[inner] - [45.0, 45.0]).T))])
    around = np.flatnonzero((MESH.interface_elements == element).any(axis=1))
    body.check_attached(body.domain.edges(around))
    body.loosen(body.domain.edges(around))
    loose = body.loose()
    assert loose is not None and np.flatnonzero(loose).tolist() == [element]
    body.domain.close()
