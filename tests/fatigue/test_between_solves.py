import numpy as np
import pytest

from pearlite_petsc.fatigue.between_solves import damage_at_end
from pearlite_petsc.fatigue.course import Course
from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.laws import RateConstants

CYCLES = np.array([0.0, 100.0, 250.0, 400.0])
COURSE = Course(CYCLES, np.zeros((4, 1)), np.array([0.0, 0.2, 0.6, 1.0]), 0)


def drive_of(damage: list[float], normal: list[float], threshold: float = 0.0) -> Drive:
    count = len(damage)
    rates = RateConstants(np.full(count, 1e-12), np.full(count, threshold), 0.3)
    return Drive(np.array(damage), np.array(normal), np.zeros(count), rates, 1.0, False)


def test_an_interface_between_two_equal_stresses_grows_by_rate_times_cycles() -> None:
    drive = drive_of([0.0, 0.1], [1000.0, 500.0])
    found = damage_at_end(drive, drive.normal, drive.shear, COURSE)
    assert found == pytest.approx([0.4, 0.1 + 1.25e-4 * 400.0], rel=1e-12)


def test_a_rising_stress_is_integrated_along_the_released_force() -> None:
    drive = drive_of([0.0, 0.0], [1000.0, 400.0], threshold=450.0)
    found = damage_at_end(drive, np.array([0.0, 700.0]), np.zeros(2), COURSE)
    rate = [1e-12 * max(400.0 + 300.0 * part - 450.0, 0.0) ** 3 for part in (0.0, 0.2, 0.6, 1.0)]
    steps = zip(rate[:-1], rate[1:], (100.0, 150.0, 150.0), strict=True)
    assert found[1] == pytest.approx(sum(0.5 * (a + b) * n for a, b, n in steps), rel=1e-12)
    # Neither the stress at the start (below the threshold) nor the one at the end alone.
    assert 0.0 < found[1] < 1e-12 * 250.0**3 * CYCLES[-1]


def test_what_stays_below_the_threshold_keeps_its_damage() -> None:
    drive = drive_of([0.0, 0.25], [1000.0, 100.0], threshold=300.0)
    found = damage_at_end(drive, np.array([0.0, 299.0]), np.zeros(2), COURSE)
    assert found[1] == 0.25
