import numpy as np
import pytest

from pearlite_petsc.microstructure.shear import (
    deformation_gradient,
    orientation_order,
    preferred_angle,
    sheared_angle,
    sheared_angle_cdf,
)
from pearlite_petsc.scene import Orientation

ORIENTATIONS: tuple[Orientation, ...] = ("AT", "TA")


def test_at_shear_adds_gamma_to_the_cotangent() -> None:
    angle = np.linspace(0.05, 3.1, 40)
    turned = sheared_angle(angle, deformation_gradient(2.0, "AT"))
    assert np.allclose(1 / np.tan(turned), 1 / np.tan(angle) + 2.0, rtol=1e-12, atol=1e-12)


def test_ta_shear_adds_gamma_to_the_tangent() -> None:
    angle = np.linspace(0.05, 3.1, 40)
    turned = sheared_angle(angle, deformation_gradient(2.0, "TA"))
    assert np.allclose(np.tan(turned), np.tan(angle) + 2.0, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("orientation", ORIENTATIONS)
@pytest.mark.parametrize("gamma", [0.0, 2.0, 30.0])
def test_turned_directions_stay_in_the_half_turn_and_in_their_distribution(
    gamma: float, orientation: Orientation
) -> None:
    share = (np.arange(2000) + 0.5) / 2000
    angle = np.sort(sheared_angle(share * np.pi, deformation_gradient(gamma, orientation)))
    assert 0 <= angle[0] <= angle[-1] < np.pi
    assert np.abs(sheared_angle_cdf(angle, gamma, orientation) - share).max() < 1.01 / 2000


@pytest.mark.parametrize("orientation", ORIENTATIONS)
@pytest.mark.parametrize("gamma", [0.5, 2.0, 30.0])
def test_the_density_peaks_at_the_preferred_angle(gamma: float, orientation: Orientation) -> None:
    angle = np.linspace(0.0, np.pi, 400_001)
    density = np.gradient(sheared_angle_cdf(angle, gamma, orientation), angle)
    assert abs(angle[density.argmax()] - preferred_angle(gamma, orientation)) < 2e-5


@pytest.mark.parametrize("gamma", [0.5, 2.0, 30.0])
def test_orientation_order_is_the_second_moment_of_the_distribution(gamma: float) -> None:
    share = (np.arange(1_000_000) + 0.5) / 1e6
    angle = sheared_angle(share * np.pi, deformation_gradient(gamma, "AT"))
    assert abs(abs(np.exp(2j * angle).mean()) - orientation_order(gamma)) < 1e-6


def test_a_direction_along_the_shear_plane_does_not_turn() -> None:
    assert sheared_angle(np.array([0.0]), deformation_gradient(30.0, "AT"))[0] == 0.0
    across = np.array([0.5 * np.pi])
    assert abs(sheared_angle(across, deformation_gradient(30.0, "TA"))[0] - 0.5 * np.pi) < 1e-15
