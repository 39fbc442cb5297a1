import numpy as np
import pytest
from scipy.integrate import quad

from pearlite_petsc.fatigue.cycle_jump import LARGEST_SHARE, Drive
from pearlite_petsc.fatigue.damage import DamageLaw
from pearlite_petsc.fatigue.look_back import course_of, damage_after, leading_share


def drive_of(damage: list[float], normal: list[float], threshold: float = 0.0) -> Drive:
    count = len(damage)
    law = DamageLaw(np.full(count, 1e-12), np.full(count, threshold), 0.3)
    return Drive(np.array(damage), np.array(normal), np.zeros(count), law, 1.0, False)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.7, 0.94])
def test_the_share_is_found_again_from_the_stresses_round_a_block(share: float) -> None:
    for start, end in ((0.0, 1.0), (0.2, 0.7), (0.9, 1.0)):
        before, after = (100.0 / (1 - share * damage) for damage in (start, end))
        assert leading_share(before, after, start, end) == pytest.approx(share, abs=1e-9)


def test_a_falling_stress_has_no_share_and_a_runaway_one_the_largest() -> None:
    assert leading_share(100.0, 80.0, 0.0, 0.5) == 0.0
    assert leading_share(100.0, 1e9, 0.0, 0.5) == LARGEST_SHARE


@pytest.mark.parametrize(("start", "end"), [(0.0, 1.0), (0.3, 0.8)])
def test_a_course_takes_the_cycles_of_a_softening_spring(start: float, end: float) -> None:
    share, stress = 0.6, 1000.0

    def slowness(damage: float) -> float:
        return 1e12 * ((1 - share * damage) / (stress * (1 - share * start))) ** 3

    course = course_of(drive_of([start], [stress]).take(np.array([0])), share, end)
    assert course.cycles[0] == 0.0 and (np.diff(course.cycles) > 0).all()
    assert course.cycles[-1] == pytest.approx(quad(slowness, start, end)[0], rel=5e-3)
    assert course.released[[0, -1]].tolist() == [0.0, 1.0]
    assert (np.diff(course.released) > 0).all()


def test_an_interface_between_two_equal_stresses_grows_by_rate_times_cycles() -> None:
    drive = drive_of([0.0, 0.1], [1000.0, 500.0])
    course = course_of(drive.take(np.array([0])), 0.5, 0.6)
    found = damage_after(drive, drive.normal, drive.shear, course)
    assert found[1] == pytest.approx(0.1 + 1.25e-4 * course.cycles[-1], rel=1e-12)


def test_a_rising_stress_is_integrated_along_the_released_force() -> None:
    drive = drive_of([0.0, 0.0], [1000.0, 400.0], threshold=450.0)
    course = course_of(drive.take(np.array([0])), 0.5, 1.0)
    found = damage_after(drive, np.array([0.0, 700.0]), np.zeros(2), course)
    stress = 400.0 + 300.0 * course.released
    rate = 1e-12 * np.maximum(stress - 450.0, 0.0) ** 3
    exact = float((0.5 * (rate[1:] + rate[:-1]) * np.diff(course.cycles)).sum())
    assert found[1] == pytest.approx(exact, rel=1e-12)
    # Neither the stress at the start (below the threshold) nor the one at the end alone.
    assert 0.0 < found[1] < 1e-12 * 250.0**3 * course.cycles[-1]


def test_what_stays_below_the_threshold_keeps_its_damage() -> None:
    drive = drive_of([0.0, 0.25], [1000.0, 100.0], threshold=300.0)
    course = course_of(drive.take(np.array([0])), 0.5, 1.0)
    found = damage_after(drive, np.array([0.0, 299.0]), np.zeros(2), course)
    assert found[1] == 0.25
