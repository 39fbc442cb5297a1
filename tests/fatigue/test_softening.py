"""Jumps of interfaces that soften together, against dense algebra of a whole body."""

from dataclasses import replace

import numpy as np
import pytest

from pearlite_petsc.fatigue.course import course_of
from tests.fatigue.few_interfaces import COUNT, DAMAGE, following, softening


def body() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return stiffness, jump rows and load of a small body with three springs among others."""
    rng = np.random.default_rng(2)
    rows = rng.normal(size=(3 * COUNT, 12))
    base = rng.normal(size=(12, 12))
    return base @ base.T + 12.0 * np.eye(12), rows, rng.normal(size=12)


def test_the_jumps_at_any_damage_are_those_of_the_whole_body() -> None:
    rest, rows, load = body()
    constants = np.full((COUNT, 3), 1.2)
    before, after = np.array([0.1, 0.0, 0.3]), np.array([0.8, 0.25, 1.0])

    def stiffness(damage: np.ndarray) -> np.ndarray:
        springs = np.repeat(1.0 - damage, 3) * constants.ravel()
        return rest + rows.T @ (springs[:, None] * rows)

    compliance = rows @ np.linalg.solve(stiffness(before), rows.T)
    jump = (rows @ np.linalg.solve(stiffness(before), load)).reshape(COUNT, 3)
    found = softening(compliance=compliance, jump=jump).jumps_at(after)
    exact = (rows @ np.linalg.solve(stiffness(after), load)).reshape(COUNT, 3)
    assert found == pytest.approx(exact, rel=1e-10)


def test_a_solve_that_finds_what_was_foreseen_corrects_nothing() -> None:
    case = softening()
    end = np.array([0.9, 0.5, 0.6])
    assert case.corrected(end, case.jumps_at(end)).correction is None


def test_a_corrected_course_ends_with_the_jumps_of_the_solve() -> None:
    case = softening()
    end = course_of(case).damage[-1]
    seen = 1.3 * case.jumps_at(end)
    corrected = case.corrected(end, seen)
    assert corrected.correction is not None
    assert corrected.jumps_at(case.damage) == pytest.approx(case.jump)
    weight = corrected.force_let_go(end, case.jumps_at(end)) / corrected.correction.force
    assert corrected.jumps_at(end) == pytest.approx(
        case.jumps_at(end) + weight * (seen - case.jumps_at(end))
    )
    # More stress on the way: a shorter one.
    assert course_of(corrected).cycles[-1] < course_of(case).cycles[-1]


def test_a_load_that_follows_the_tip_adds_its_pull() -> None:
    pull = np.zeros((COUNT, 3, 2))
    pull[:, 0, 0] = -0.02
    advance = np.array([[0.0, 0.0], [4.0, 1.0], [2.0, 0.0]])
    case = softening(load=following(DAMAGE, 0.4, advance, pull))
    after = np.array([0.1, 0.5, 0.3])
    before = 0.3 * 0.6 / (1.0 - 0.4 * 0.3)
    let_go = 0.5 * 0.6 / (1.0 - 0.4 * 0.5)
    # At the start the load is on its way to where the third interface leads.
    assert case.load.centre(case.damage) == pytest.approx((2.0 * before, 0.0))
    assert case.load.centre(after) == pytest.approx((4.0 * let_go, let_go))
    moved = pull[:, :, 0] * (4.0 * let_go - 2.0 * before)
    plain = replace(case, jump=case.jump + moved, load=following(DAMAGE, 0.4))
    assert case.jumps_at(after) == pytest.approx(plain.jumps_at(after))
    assert case.jumps_at(case.damage) == pytest.approx(case.jump)
