import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.fatigue.extrapolation import Extrapolation, RateModel
from pearlite_petsc.laws import RateConstants

MODELS: tuple[RateModel, ...] = ("euler", "exponential", "compliance")


def drive_of(
    damage: list[float],
    normal: list[float],
    sensitivity: list[float] | None = None,
    threshold: float = 0.0,
    failure: float = 1.0,
    nominal: bool = False,
) -> Drive:
    count = len(damage)
    rates = RateConstants(np.full(count, 1e-12), np.full(count, threshold), 0.3)
    return Drive(
        np.array(damage, dtype=float),
        np.array(normal, dtype=float),
        np.zeros(count),
        rates,
        failure,
        nominal,
        None if sensitivity is None else np.array(sensitivity, dtype=float),
    )


def test_eulers_block_ends_when_the_first_interface_has_gained_the_increment() -> None:
    drive = drive_of([0.0, 0.4, 0.1], [1000.0, 2000.0, 500.0])
    block = Extrapolation(drive, 0.2, "euler")
    rates = [1e-3, 8e-3, 1.25e-4]
    assert block.rate == pytest.approx(rates)
    assert block.longest == pytest.approx(0.2 / 8e-3)
    after = block.damage_after(block.longest)
    assert after == pytest.approx([0.0 + 1e-3 * 25, 0.6, 0.1 + 1.25e-4 * 25])


def test_a_block_ends_exactly_when_its_first_interface_breaks() -> None:
    drive = drive_of([0.9, 0.0], [1000.0, 1000.0])
    block = Extrapolation(drive, 0.5, "euler")
    assert block.longest == pytest.approx(100.0)
    assert block.damage_after(block.longest)[0] == 1.0


@pytest.mark.parametrize("model", MODELS)
def test_no_rate_anywhere_makes_a_block_without_end(model: RateModel) -> None:
    drive = drive_of([0.0, 1.0], [50.0, 0.0], [0.5, 0.5], threshold=50.0)
    assert Extrapolation(drive, 0.5, model).longest == math.inf
    assert Extrapolation(drive_of([], [], []), 0.5, model).longest == math.inf


def test_under_constant_stress_all_of_the_life_is_one_over_the_rate() -> None:
    for model in MODELS:
        block = Extrapolation(drive_of([0.0], [1000.0], [0.0]), 1.0, model)
        assert block.longest == pytest.approx(1000.0, rel=1e-12)
        assert block.damage_after(250.0) == pytest.approx([0.25], rel=1e-12)


def test_the_exponential_rate_has_its_closed_form() -> None:
    lam, start = 3.0, 0.2
    block = Extrapolation(drive_of([start], [1000.0], [lam]), 0.5, "exponential")
    exact = (1 - math.exp(-lam * 0.5)) / (lam * 1e-3)
    # The table's trapezoids are the only error.
    assert block.longest == pytest.approx(exact, rel=1e-3)
    cycles = 0.6 * exact
    damage = start - math.log(1 - lam * 1e-3 * cycles) / lam
    assert block.damage_after(cycles)[0] == pytest.approx(damage, abs=1e-3)


@pytest.mark.parametrize("threshold", [0.0, 600.0])
def test_the_compliance_rate_is_the_integral_of_a_softening_spring(threshold: float) -> None:
    share, start = 0.7, 0.3
    stress = 1000.0

    def slowness(damage: float) -> float:
        now = stress * (1 - share * start) / (1 - share * damage)
        return 1.0 / (1e-12 * (now - threshold) ** 3)

    block = Extrapolation(drive_of([start], [stress], [share], threshold), 1.0, "compliance")
    assert block.longest == pytest.approx(quad(slowness, start, 1.0)[0], rel=2e-3)
    part = quad(slowness, start, 0.6)[0]
    assert block.damage_after(part)[0] == pytest.approx(0.6, abs=2e-3)


def test_blocks_of_the_compliance_rate_add_up_to_one_long_block() -> None:
    share = 0.6
    whole = Extrapolation(drive_of([0.0], [1000.0], [share]), 1.0, "compliance").longest
    damage, cycles, blocks = 0.0, 0.0, 0
    while damage < 1.0:
        stress = 1000.0 / (1 - share * damage)
        block = Extrapolation(drive_of([damage], [stress], [share]), 0.3, "compliance")
        damage = float(block.damage_after(block.longest)[0])
        cycles += block.longest
        blocks += 1
    assert blocks > 2
    assert cycles == pytest.approx(whole, rel=2e-3)


def test_the_nominal_stress_slows_down_by_the_third_power_of_what_is_left() -> None:
    sound = Extrapolation(drive_of([0.5], [1000.0]), 0.1, "euler").rate
    nominal = Extrapolation(
        drive_of([0.5], [1000.0], nominal=True, failure=0.99), 0.1, "euler"
    ).rate
    assert nominal == pytest.approx(sound / 8.0)


def test_a_nominal_interface_breaks_at_its_failure_damage() -> None:
    drive = drive_of([0.95, 1.0], [1000.0, 0.0], nominal=True, failure=0.97)
    block = Extrapolation(drive, 0.5, "euler")
    assert block.longest == pytest.approx(0.02 / (1e-3 * 0.05**3), rel=1e-9)
    assert block.damage_after(block.longest).tolist() == [1.0, 1.0]


@pytest.mark.parametrize("model", MODELS)
def test_a_larger_constant_only_scales_the_cycles(model: RateModel) -> None:
    drive = drive_of([0.0, 0.3, 0.6], [900.0, 1100.0, 700.0], [0.5, 0.4, 0.8])
    rates = RateConstants(2 * drive.rates.factor, drive.rates.threshold, drive.rates.beta)
    faster = Drive(drive.damage, drive.normal, drive.shear, rates, 1.0, False, drive.sensitivity)
    one, two = Extrapolation(drive, 0.5, model), Extrapolation(faster, 0.5, model)
    assert two.longest == pytest.approx(one.longest / 2, rel=1e-14)
    assert np.allclose(
        one.damage_after(one.longest), two.damage_after(two.longest), rtol=0, atol=1e-14
    )


@pytest.mark.parametrize("model", MODELS)
@given(
    st.lists(
        st.tuples(st.floats(0.0, 0.99), st.floats(0.0, 3000.0), st.floats(0.0, 0.9)),
        min_size=1,
        max_size=6,
    ),
    st.floats(0.05, 1.0),
)
def test_damage_only_grows_within_the_increment_and_one_interface_uses_it_up(
    model: RateModel, interfaces: list[tuple[float, float, float]], delta_d: float
) -> None:
    damage, normal, share = map(list, zip(*interfaces, strict=True))
    drive = drive_of(damage, normal, share, threshold=300.0)
    block = Extrapolation(drive, delta_d, model)
    if not math.isfinite(block.longest):
        assert all(stress <= 300.0 for stress in normal)
        return
    before = drive.damage
    # The compliance model may measure its steps otherwise; failure is its limit in any case.
    most = 1.0 if model == "compliance" else delta_d
    limit = np.minimum(before + most, 1.0)
    half, whole = block.damage_after(0.5 * block.longest), block.damage_after(block.longest)
    assert (before <= half).all() and (half <= whole + 1e-12).all()
    assert (whole <= limit + 2e-6).all()
    assert model == "compliance" or np.isclose(whole, limit, rtol=0, atol=1e-9).any()
    assert (whole > before)[np.array(normal) > 301.0].all()
    still = np.array(normal) <= 300.0
    assert np.array_equal(whole[still], before[still])


def test_after_no_cycles_the_damage_is_what_it_was() -> None:
    drive = drive_of([0.0, 0.3, 1.0], [900.0, 1100.0, 0.0], [0.5, 0.4, 0.8])
    for model in MODELS:
        assert Extrapolation(drive, 0.5, model).damage_after(0.0) == pytest.approx([0.0, 0.3, 1.0])


def test_taking_interfaces_keeps_each_ones_own_values() -> None:
    drive = drive_of([0.1, 0.2, 0.3], [1.0, 2.0, 3.0], [0.4, 0.5, 0.6])
    taken = drive.of(np.array([2, 0]))
    assert taken.damage.tolist() == [[0.3], [0.1]]
    assert taken.normal.tolist() == [[3.0], [1.0]]
    assert taken.sensitivity is not None and taken.sensitivity.tolist() == [[0.6], [0.4]]
    assert drive_of([0.1], [1.0]).of(np.array([0])).sensitivity is None
