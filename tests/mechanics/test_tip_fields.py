import numpy as np
import pytest

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.mechanics.tip_fields import fit_tip_fields

E, NU = 206e3, 0.3
TIP = (3.0, -2.0)


def ring(seed: int = 1) -> FloatArray:
    """Return places all round the tip."""
    random = np.random.default_rng(seed)
    radius, turn = random.uniform(2.0, 10.0, 300), random.uniform(-np.pi, np.pi, 300)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1) + TIP


def textbook(points: FloatArray, k_1: float, k_2: float, angle: float) -> FloatArray:
    """Return the singular displacements as Anderson, Fracture Mechanics, table 2.2 writes them."""
    cos, sin = np.cos(angle), np.sin(angle)
    turned = np.array([[cos, -sin], [sin, cos]])
    x, y = ((points - TIP) @ turned).T
    r, t = np.hypot(x, y), np.arctan2(y, x)
    kappa, mu = (3.0 - NU) / (1.0 + NU), 0.5 * E / (1.0 + NU)
    c, s = np.cos(0.5 * t), np.sin(0.5 * t)
    common = np.sqrt(r / (2.0 * np.pi)) / (2.0 * mu)
    one = np.stack([c * (kappa - 1.0 + 2.0 * s**2), s * (kappa + 1.0 - 2.0 * c**2)])
    two = np.stack([s * (kappa + 1.0 + 2.0 * c**2), -c * (kappa - 1.0 - 2.0 * s**2)])
    return (common * (k_1 * one + k_2 * two)).T @ turned.T


@pytest.mark.parametrize("angle", [0.0, 0.7, -2.5])
def test_the_textbook_field_gives_its_own_k_in_any_direction(angle: float) -> None:
    points = ring()
    moved = textbook(points, 18e3, -7e3, angle)
    rigid = np.array([0.3, -0.2]) + 1e-3 * (points - TIP) @ [[0.0, 1.0], [-1.0, 0.0]]
    found = fit_tip_fields(points, moved + rigid, TIP, angle, 2.0, 10.0, E, NU)
    assert found.k_1 == pytest.approx(18e3, rel=1e-9)
    assert found.k_2 == pytest.approx(-7e3, rel=1e-9)
    assert found.t_stress == pytest.approx(0.0, abs=1e-6)
    assert found.misfit < 1e-9


def test_a_stress_along_the_crack_is_t() -> None:
    points = ring()
    strain = np.diag([100.0 / E, -NU * 100.0 / E])
    found = fit_tip_fields(points, points @ strain, TIP, 0.0, 2.0, 10.0, E, NU)
    assert found.t_stress == pytest.approx(100.0, rel=1e-9)
    assert found.k_1 == pytest.approx(0.0, abs=1e-6)


def test_noise_shows_as_misfit() -> None:
    points = ring()
    moved = textbook(points, 18e3, 0.0, 0.0)
    noise = np.random.default_rng(2).normal(0.0, 0.1 * np.std(moved), moved.shape)
    found = fit_tip_fields(points, moved + noise, TIP, 0.0, 2.0, 10.0, E, NU)
    assert 0.05 < found.misfit < 0.15


def test_too_few_elements_are_refused() -> None:
    points = ring()[:11]
    with pytest.raises(PearliteError, match="holds [0-9]+ elements, 14 are needed"):
        fit_tip_fields(points, points, TIP, 0.0, 2.0, 10.0, E, NU)
