import math

import numpy as np
import pytest
from scipy.integrate import quad

from pearlite_petsc.mechanics.lefm import (
    TIP_FACTOR,
    centre_crack_factor,
    edge_crack_factor,
    remote_stress,
    reversed_plastic_zone,
    tip_stress,
)


@pytest.mark.parametrize(
    ("ratio", "accurate"),
    # Kaya and Erdogan 1987, integral equation.
    [(0.1, 1.1892), (0.2, 1.3673), (0.3, 1.6599), (0.4, 2.1114), (0.5, 2.8246), (0.6, 4.0332)],
)
def test_the_edge_crack_factor_is_within_six_thousandths(ratio: float, accurate: float) -> None:
    assert edge_crack_factor(ratio) == pytest.approx(accurate, rel=6e-3)


def test_a_short_edge_crack_is_that_of_a_half_plane() -> None:
    assert edge_crack_factor(1e-6) == pytest.approx(1.1215, abs=1e-3)


@pytest.mark.parametrize(
    ("ratio", "accurate"),
    # Isida 1971, Laurent series.
    [(0.1, 1.0060), (0.2, 1.0246), (0.3, 1.0577), (0.4, 1.1094), (0.5, 1.1867), (0.6, 1.3033)],
)
def test_the_centre_crack_factor_is_within_a_few_thousandths(ratio: float, accurate: float) -> None:
    assert centre_crack_factor(ratio) == pytest.approx(accurate, rel=2e-3)


def test_factors_rise_with_the_crack() -> None:
    ratios = np.linspace(0.01, 0.95, 60)
    for factor in (edge_crack_factor, centre_crack_factor):
        assert (np.diff([factor(ratio) for ratio in ratios]) > 0).all()


def test_the_remote_stress_gives_its_k_back() -> None:
    stress = remote_stress(2e4, 80.0, 200.0)
    assert stress * edge_crack_factor(0.4) * math.sqrt(math.pi * 80.0) == pytest.approx(2e4)
    # At 20 MPa sqrt(m) the default window is above the yield stress of the undeformed steel.
    assert stress == pytest.approx(2e4 / (2.1114 * math.sqrt(math.pi * 80.0)), rel=5e-3)


def test_the_reversed_plastic_zone_has_the_size_that_the_report_warns_of() -> None:
    assert reversed_plastic_zone(2e4, 470.0) == pytest.approx(144.1, abs=0.1)
    assert reversed_plastic_zone(4e4, 470.0) == pytest.approx(4 * 144.1, abs=0.4)


def test_the_tip_stress_is_the_mean_of_the_singular_stress_over_the_length() -> None:
    k, length = 2e4, 3.7
    mean = quad(lambda r: k / math.sqrt(2 * math.pi * r), 0, length)[0] / length
    assert tip_stress(k, np.array([length]))[0] == pytest.approx(mean, rel=1e-8)
    assert pytest.approx(math.sqrt(2 / math.pi), rel=1e-15) == TIP_FACTOR
