import numpy as np
import pytest
from scipy.stats import linregress
from scipy.stats import t as student

from pearlite_petsc.fatigue.growth_curve import power_law, threshold

DELTA_K = np.array([4.0, 4.5, 5.0, 6.0, 7.0, 9.0, 12.0])


def test_a_power_law_is_found_again() -> None:
    law = power_law(DELTA_K, 3e-13 * DELTA_K**3.2)
    assert law is not None and law.points == 7
    assert law.slope == pytest.approx(3.2, rel=1e-12)
    assert np.exp(law.logarithm) == pytest.approx(3e-13, rel=1e-10)
    assert law.slope_error == pytest.approx(0.0, abs=1e-10)
    assert law.delta_k_at(3e-13 * 5.5**3.2) == pytest.approx(5.5, rel=1e-12)


def test_its_interval_is_that_of_ordinary_regression() -> None:
    noise = np.random.default_rng(3).normal(0.0, 0.2, len(DELTA_K))
    rate = 3e-13 * DELTA_K**3 * np.exp(noise)
    law, fit = power_law(DELTA_K, rate), linregress(np.log(DELTA_K), np.log(rate))
    assert law is not None
    assert law.slope == pytest.approx(fit.slope, rel=1e-12)
    assert law.slope_error == pytest.approx(student.ppf(0.975, 5) * fit.stderr, rel=1e-9)


def test_points_without_a_rate_are_passed_over() -> None:
    rate = 3e-13 * DELTA_K**3
    rate[[0, 3]] = np.nan, 0.0
    law = power_law(DELTA_K, rate)
    assert law is not None and law.points == 5 and law.slope == pytest.approx(3.0, rel=1e-12)


def test_one_delta_k_has_no_slope() -> None:
    assert power_law(np.full(3, 18.0), np.array([1e-9, 2e-9, 3e-9])) is None


def test_the_threshold_lies_at_1e_10_on_the_line_through_the_slow_points() -> None:
    delta_k = np.geomspace(5.05, 5.9, 8)
    rate = 1e-10 * (delta_k / 5.0) ** 12
    # Fast points do not bend the line.
    delta_k, rate = np.append(delta_k, [20.0, 30.0]), np.append(rate, [1e-8, 3e-8])
    assert threshold(delta_k, rate) == pytest.approx(5.0, rel=1e-12)


def test_a_curve_that_stays_above_has_no_threshold() -> None:
    assert np.isnan(threshold(DELTA_K, 1e-9 * DELTA_K**3))
    few = np.array([5.1, 5.2, 5.3, 5.4])
    assert np.isnan(threshold(few, 1e-10 * (few / 5.0) ** 10))
