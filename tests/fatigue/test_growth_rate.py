import numpy as np
import pytest

from pearlite_petsc.fatigue.growth_rate import advances, incremental_polynomial, secant, slope

CYCLES = np.array([0.0, 3.0, 10.0, 12.0, 30.0, 31.0, 45.0, 60.0, 80.0])


def test_rows_count_where_the_crack_is_longer_than_ever_before() -> None:
    length = np.array([80.0, 80.0, 81.0, 80.5, 80.9, 81.0, 82.0])
    assert np.flatnonzero(advances(length)).tolist() == [0, 2, 6]


def test_the_slope_is_that_of_a_straight_line_fit() -> None:
    length = 5.0 + 0.2 * CYCLES + np.random.default_rng(1).normal(size=len(CYCLES))
    assert slope(CYCLES, length) == pytest.approx(np.polyfit(CYCLES, length, 1)[0], rel=1e-10)
    assert slope(CYCLES, 5.0 + 0.2 * CYCLES) == pytest.approx(0.2, rel=1e-13)


def test_the_slope_scales_with_lengths_and_cycles_and_ignores_their_origin() -> None:
    length = np.sqrt(CYCLES)
    one = slope(CYCLES, length)
    assert slope(2 * CYCLES, length) == pytest.approx(one / 2, rel=1e-13)
    assert slope(CYCLES, 3 * length) == pytest.approx(3 * one, rel=1e-13)
    assert slope(CYCLES + 7.0, length - 4.0) == pytest.approx(one, rel=1e-10)


def test_without_cycles_there_is_no_slope() -> None:
    assert np.isnan(slope(np.array([0.0]), np.array([80.0])))
    assert np.isnan(slope(np.zeros(3), np.array([1.0, 2.0, 3.0])))


def test_the_secant_is_the_rise_of_the_step_that_ended_there() -> None:
    cycles, length = np.array([0.0, 2.0, 2.0, 6.0]), np.array([1.0, 2.0, 3.0, 5.0])
    assert np.array_equal(secant(cycles, length), [np.nan, 0.5, np.nan, 0.5], equal_nan=True)


def test_the_polynomial_finds_the_rate_of_a_parabola_exactly() -> None:
    length = 80.0 + 0.1 * CYCLES + 0.003 * CYCLES**2
    rate = incremental_polynomial(CYCLES, length)
    assert rate[3:-3] == pytest.approx((0.1 + 0.006 * CYCLES)[3:-3], rel=1e-9)
    assert np.isnan(rate[[0, 1, 2, -3, -2, -1]]).all()


def test_fewer_than_seven_points_give_no_polynomial() -> None:
    assert np.isnan(incremental_polynomial(CYCLES[:6], CYCLES[:6])).all()
    assert np.isfinite(incremental_polynomial(CYCLES[:7], CYCLES[:7])).sum() == 1


def test_seven_points_at_two_moments_give_no_polynomial() -> None:
    cycles = np.repeat([0.0, 5.0], [4, 3])
    assert np.isnan(incremental_polynomial(cycles, np.arange(7.0))).all()


def test_all_three_rates_agree_on_a_straight_line() -> None:
    length = 80.0 + 0.37 * CYCLES
    assert slope(CYCLES, length) == pytest.approx(0.37, rel=1e-12)
    assert secant(CYCLES, length)[1:] == pytest.approx(0.37, rel=1e-12)
    assert incremental_polynomial(CYCLES, length)[3:-3] == pytest.approx(0.37, rel=1e-9)
