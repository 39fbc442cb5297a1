"""The course of interfaces that soften together, against closed forms and an ODE solver."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pearlite_petsc.fatigue.course import course_of
from pearlite_petsc.laws import RateConstants
from tests.fatigue.few_interfaces import COUNT, one_in_series, softening


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


def test_a_block_ends_in_time_where_it_must_not_go_on() -> None:
    whole = course_of(softening()).cycles[-1]
    short = course_of(softening(), longest=0.3 * whole)
    assert short.first is None
    assert 0.15 * whole <= short.cycles[-1] <= 0.3 * whole


def test_nothing_goes_on_below_the_threshold() -> None:
    rates = RateConstants(np.full(COUNT, 1e-12), np.full(COUNT, 1e4), 0.3)
    course = course_of(softening(rates=rates))
    assert course.first is None and course.cycles.tolist() == [0.0]


def test_a_course_that_hits_another_limit_first_ends_there() -> None:
    limit = np.array([1.0, 1.0, 0.32])
    course = course_of(softening(limit=limit))
    assert course.first == 2
    assert course.damage[-1, 2] == 0.32
    assert (course.damage[-1, :2] < 1.0).all()
