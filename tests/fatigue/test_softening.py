"""Interfaces that soften together, against springs in series, dense algebra and an ODE solver."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pearlite_petsc.fatigue.softening import Softening, course_of
from pearlite_petsc.laws import RateConstants

COUNT = 3
RNG = np.random.default_rng(5)
ROOT = RNG.normal(size=(3 * COUNT, 3 * COUNT))
COMPLIANCE = 0.04 * ROOT @ ROOT.T / 9.0 + 0.3 * np.eye(3 * COUNT)


def softening(**changes: Any) -> Softening:
    values: dict[str, Any] = {
        "damage": np.array([0.1, 0.0, 0.3]),
        "limit": np.ones(COUNT),
        "jump": np.array([[1.0, 0.2, 0.0], [0.9, -0.3, 0.01], [0.7, 0.1, 0.0]]),
        "constants": np.full((COUNT, 3), 1.2),
        "springs": np.full((COUNT, 2), 1000.0),
        "compliance": COMPLIANCE,
        "law": RateConstants(np.full(COUNT, 1e-12), np.full(COUNT, 100.0), 0.3),
        "nominal": False,
        "share": np.full(COUNT, 0.4),
        "advance": np.zeros((COUNT, 2)),
        "centre": np.zeros(2),
        "pull": np.zeros((COUNT, 3, 2)),
        "residual": np.zeros((COUNT, 3)),
    }
    return Softening(**values | changes)


def one_in_series(share: float) -> Softening:
    """Return an interface with the share g of the compliance of all that it hangs on."""
    return softening(
        damage=np.zeros(1),
        limit=np.ones(1),
        jump=np.array([[1.0, 0.0, 0.0]]),
        constants=np.ones((1, 3)),
        springs=np.full((1, 2), 1000.0),
        compliance=share * np.eye(3),
        law=RateConstants(np.array([1e-12]), np.zeros(1), 0.3),
        share=np.array([share]),
        advance=np.zeros((1, 2)),
        pull=np.zeros((1, 3, 2)),
        residual=np.zeros((1, 3)),
    )


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


@pytest.mark.parametrize("share", [0.2, 0.6, 0.9])
def test_one_interface_in_series_has_the_life_of_its_closed_form(share: float) -> None:
    course = course_of(one_in_series(share))
    exact = (1.0 - (1.0 - share) ** 4) / (4.0 * share * 1e-3)
    assert course.first == 0
    assert course.damage[-1, 0] == 1.0
    assert course.cycles[-1] == pytest.approx(exact, rel=2e-3)


def test_the_course_is_that_of_an_ode_solver() -> None:
    case = softening()

    def rate(_: float, damage: np.ndarray) -> np.ndarray:
        return case.rate_at(damage, case.jumps_at(damage))

    def broken(_: float, damage: np.ndarray) -> float:
        return float(damage.max() - 1.0)

    broken.terminal = True  # type: ignore[attr-defined]
    exact = solve_ivp(rate, (0.0, 1e5), case.damage, "DOP853", events=broken, rtol=1e-9, atol=1e-11)
    course = course_of(case)
    assert course.first == int(np.argmax(exact.y[:, -1]))
    assert course.cycles[-1] == pytest.approx(exact.t[-1], rel=2e-3)
    assert course.damage[-1] == pytest.approx(exact.y[:, -1], abs=3e-3)
    assert (np.diff(course.cycles) > 0.0).all() and (np.diff(course.damage, axis=0) >= 0.0).all()
    assert course.released[0] == 0.0 and course.released[-1] == 1.0


def test_a_solve_that_finds_what_was_foreseen_corrects_nothing() -> None:
    case = softening()
    end = np.array([0.9, 0.5, 0.6])
    assert not case.corrected(end, case.jumps_at(end)).is_corrected


def test_a_corrected_course_ends_with_the_jumps_of_the_solve() -> None:
    case = softening()
    end = course_of(case).damage[-1]
    seen = 1.3 * case.jumps_at(end)
    corrected = case.corrected(end, seen)
    assert corrected.is_corrected
    assert corrected.jumps_at(case.damage) == pytest.approx(case.jump)
    weight = corrected.moment(end, case.jumps_at(end)) / corrected.moment_end
    assert corrected.jumps_at(end) == pytest.approx(
        case.jumps_at(end) + weight * (seen - case.jumps_at(end))
    )
    # More stress on the way: a shorter one.
    assert course_of(corrected).cycles[-1] < course_of(case).cycles[-1]


def test_a_load_that_follows_the_tip_adds_its_pull() -> None:
    pull = np.zeros((COUNT, 3, 2))
    pull[:, 0, 0] = -0.02
    advance = np.array([[0.0, 0.0], [4.0, 1.0], [2.0, 0.0]])
    case = softening(pull=pull, advance=advance)
    after = np.array([0.1, 0.5, 0.3])
    let_go = 0.5 * 0.6 / (1.0 - 0.4 * 0.5)
    plain = replace(case, jump=case.jump + pull[:, :, 0] * 4.0 * let_go, advance=0.0 * advance)
    assert case.jumps_at(after) == pytest.approx(plain.jumps_at(after))


def test_a_block_ends_in_time_where_it_must_not_go_on() -> None:
    whole = course_of(softening()).cycles[-1]
    short = course_of(softening(), longest=0.3 * whole)
    assert short.first is None
    assert 0.15 * whole <= short.cycles[-1] <= 0.3 * whole


def test_nothing_goes_on_below_the_threshold() -> None:
    law = RateConstants(np.full(COUNT, 1e-12), np.full(COUNT, 1e4), 0.3)
    course = course_of(softening(law=law))
    assert course.first is None and course.cycles.tolist() == [0.0]
