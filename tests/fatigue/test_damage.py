import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.damage import (
    CRITICAL_DISTANCE,
    OBJECTIVE,
    PRINTED,
    damage_interfaces,
    rated_length,
    strength,
    yield_stress,
)
from pearlite_petsc.laws import DamageLaw, RateConstants, cubic_rate
from pearlite_petsc.mechanics.lefm import TIP_FACTOR
from pearlite_petsc.scene import Damage, Kind, State
from tests.scenes import STATES, default_scene

DAMAGE = default_scene().damage
STATE = STATES["moderate_AT"]
PRINTED_DAMAGE = replace(DAMAGE, law=PRINTED)
KINDS = np.array([Kind.LAMELLA, Kind.CEMENTITE, Kind.COLONY, Kind.BLOCK, 4])
LENGTHS = np.array([0.3, 2.0, 4.0, 7.0, 30.0])


def constants_of(
    length: FloatArray, kind: IntArray, damage: Damage, state: State, remote: float = 0.0
) -> RateConstants:
    interfaces = damage_interfaces(length, kind, damage, state, remote)
    return damage.law.rate_constants(interfaces, damage)


def scalar_rate(
    normal: float,
    shear: float,
    length: float,
    kind: int,
    law: DamageLaw,
    threshold: str,
    remote: float,
) -> float:
    """Eq. (28)-(32) for one interface, written out."""
    s = DAMAGE.cementite_strength if kind == 1 else STATE.yield_stress
    at_tip = math.sqrt(2 / math.pi) * STATE.delta_k_th / math.sqrt(length)
    limit = at_tip if threshold == "tip" else remote
    factor = DAMAGE.c / (s * length)
    if law.name == "objective":
        factor *= (length / DAMAGE.reference_length) ** 1.5
    parts = [factor * max(stress - limit, 0.0) ** 3 for stress in (normal, abs(shear))]
    return math.sqrt(parts[0] ** 2 + DAMAGE.beta * parts[1] ** 2)


@pytest.mark.parametrize("law", [OBJECTIVE, PRINTED], ids=str)
@pytest.mark.parametrize("threshold", ["tip", "remote"])
@given(normal=st.floats(-3e4, 3e4), shear=st.floats(-3e4, 3e4))
def test_the_rate_is_that_of_the_equations_written_out(
    law: DamageLaw, threshold: str, normal: float, shear: float
) -> None:
    damage = replace(DAMAGE, law=law, threshold=threshold)
    constants = constants_of(LENGTHS, KINDS, damage, STATE, 55.0)
    found = constants.rate(np.full(5, normal), np.full(5, shear))
    for place, (length, kind) in enumerate(zip(LENGTHS.tolist(), KINDS.tolist(), strict=True)):
        exact = scalar_rate(normal, shear, length, kind, law, threshold, 55.0)
        assert found[place] == pytest.approx(exact, rel=1e-9, abs=1e-300)


def test_both_laws_agree_where_the_interface_has_the_reference_length() -> None:
    length, kind = np.array([DAMAGE.reference_length]), np.array([0])
    laws = [constants_of(length, kind, damage, STATE) for damage in (DAMAGE, PRINTED_DAMAGE)]
    assert laws[0].factor == pytest.approx(laws[1].factor, rel=1e-14)
    assert laws[0].threshold == pytest.approx(laws[1].threshold, rel=1e-14)


def test_the_objective_law_grows_a_straight_crack_equally_fast_on_any_mesh() -> None:
    delta_k, free = 2e4, STATE
    lengths = np.geomspace(0.1, 100.0, 7)
    law = constants_of(lengths, np.zeros(7, dtype=int), DAMAGE, free)
    stress = TIP_FACTOR * delta_k / np.sqrt(lengths)
    speed = lengths * law.rate(stress, np.zeros(7))
    closed = DAMAGE.c / free.yield_stress * (TIP_FACTOR / math.sqrt(DAMAGE.reference_length)) ** 3
    assert speed == pytest.approx(closed * (delta_k - free.delta_k_th) ** 3, rel=1e-12)


def test_the_printed_law_grows_it_faster_on_a_finer_mesh_by_the_power_of_three_halves() -> None:
    lengths = np.array([1.0, 4.0])
    law = constants_of(lengths, np.zeros(2, dtype=int), PRINTED_DAMAGE, STATE)
    stress = TIP_FACTOR * 2e4 / np.sqrt(lengths)
    speed = lengths * law.rate(stress, np.zeros(2))
    assert speed[0] / speed[1] == pytest.approx(8.0, rel=1e-12)


def test_nothing_grows_at_or_below_the_threshold_nor_under_compression() -> None:
    law = RateConstants(np.ones(4), np.full(4, 10.0), 0.3)
    normal = np.array([10.0, 9.0, -1e6, 0.0])
    assert law.rate(normal, np.array([0.0, -10.0, 10.0, -9.9])).tolist() == [0.0] * 4


def test_the_third_power_and_the_weight_of_the_shear() -> None:
    law = RateConstants(np.array([2.0]), np.array([0.0]), 0.3)
    one, two = np.array([5.0]), np.array([10.0])
    zero = np.zeros(1)
    assert cubic_rate(one, zero, np.array([2.0])).tolist() == [250.0]
    assert law.rate(two, zero) == pytest.approx(8 * law.rate(one, zero))
    assert law.rate(zero, one) == pytest.approx(math.sqrt(0.3) * law.rate(one, zero))
    assert law.rate(one, -two) == pytest.approx(law.rate(one, two))
    both = law.rate(one, one)
    assert both == pytest.approx(math.sqrt(1.3) * 250.0)


@given(st.floats(0.0, 1e4), st.floats(0.0, 1e4))
def test_more_stress_is_never_less_damage(stress: float, more: float) -> None:
    law = RateConstants(np.array([1e-9, 1e-9]), np.array([50.0, 50.0]), 0.3)
    rate = law.rate(np.array([stress, stress + more]), np.array([20.0, 20.0]))
    assert rate[0] <= rate[1]


def test_only_interfaces_across_lamellae_have_the_strength_of_cementite() -> None:
    kinds = np.array([kind.value for kind in Kind])
    factor = constants_of(np.full(6, 3.0), kinds, DAMAGE, STATE).factor
    weak = STATE.yield_stress / DAMAGE.cementite_strength
    assert factor / factor[0] == pytest.approx([1.0, weak, 1.0, 1.0, 1.0, 1.0], rel=1e-14)


def test_cycles_of_a_mixed_interface_are_those_of_its_parts_added_up() -> None:
    share = np.array([0.0, 0.3, 1.0])
    assert strength(share, 470.0, 2e4).tolist() == [470.0, 6329.0, 2e4]
    kinds = np.full(3, int(Kind.CEMENTITE))
    length = np.full(3, 5.0)
    mixed = damage_interfaces(length, kinds, DAMAGE, STATE, 0.0, cementite_share=share)
    stress = np.full(3, 9e3)
    cycles = 1.0 / DAMAGE.law.rate_constants(mixed, DAMAGE).rate(stress, 0.0 * stress)
    assert cycles[1] == pytest.approx(0.7 * cycles[0] + 0.3 * cycles[2], rel=1e-12)


def test_equal_strengths_leave_no_trace_of_the_kind() -> None:
    share = np.linspace(0.0, 1.0, 11)
    assert (strength(share, 616.3, 616.3) == 616.3).all()


def test_a_remote_threshold_is_one_stress_and_a_tip_threshold_falls_with_the_length() -> None:
    remote = replace(DAMAGE, threshold="remote")
    assert (constants_of(LENGTHS, KINDS, remote, STATE, 55.0).threshold == 55.0).all()
    tip = constants_of(LENGTHS, KINDS, DAMAGE, STATE, 55.0).threshold
    assert tip * np.sqrt(LENGTHS) == pytest.approx(TIP_FACTOR * STATE.delta_k_th, rel=1e-14)


def test_the_rate_is_proportional_to_c_and_to_one_over_the_strength() -> None:
    base = constants_of(LENGTHS, KINDS, DAMAGE, STATE).factor
    double_c = replace(DAMAGE, c=2 * DAMAGE.c)
    assert np.array_equal(constants_of(LENGTHS, KINDS, double_c, STATE).factor, 2 * base)
    harder = replace(STATE, yield_stress=2 * STATE.yield_stress)
    ratio = constants_of(LENGTHS, KINDS, DAMAGE, harder).factor / base
    assert ratio == pytest.approx([0.5, 1.0, 0.5, 0.5, 0.5])


def test_the_yield_stress_formula_meets_the_sheared_states_and_fails_the_undeformed_one() -> None:
    assert yield_stress(2.0) == pytest.approx(616.0)
    assert yield_stress(30.0) == pytest.approx(1024.0)
    assert yield_stress(0.0) == 0.0
    assert yield_stress(2.0) < yield_stress(10.0) < yield_stress(30.0)


NEAR_AND_FAR = np.array([0.0, 1.0, 1.5, 3.0, 10.0, 15.0, 40.0, 1e5])


def rated(distance: FloatArray, length: float = 3.0, critical: float = 30.0) -> FloatArray:
    return rated_length(np.full(len(distance), length), distance, critical)


def test_an_interface_at_the_crack_is_rated_by_its_own_length() -> None:
    assert rated(NEAR_AND_FAR[:3]).tolist() == [3.0, 3.0, 3.0]
    longer = rated(NEAR_AND_FAR, length=40.0)
    assert (longer == 40.0).all()


def test_a_far_interface_is_rated_by_the_critical_distance_whatever_its_length() -> None:
    for length in (0.5, 3.0, 12.0):
        assert rated(NEAR_AND_FAR, length)[-1] == pytest.approx(30.0, rel=1e-9)
        assert (np.diff(rated(NEAR_AND_FAR, length)) >= 0.0).all()


def test_the_rated_length_is_that_of_the_mean_stress_of_a_tips_field() -> None:
    k, length = 18e3, 3.0
    for distance in (1.5, 1.8, 2.8, 5.0):
        near, far = distance - 0.5 * length, distance + 0.5 * length
        mean = k * math.sqrt(2.0 / math.pi) * (math.sqrt(far) - math.sqrt(near)) / length
        found = rated(np.array([distance]), length, critical=1e4)[0]
        at_sixty_degrees = min(0.75 * math.sqrt(3.0) * mean, TIP_FACTOR * k / math.sqrt(length))
        if distance in (1.5, 2.8, 5.0):
            assert TIP_FACTOR * k / math.sqrt(found) == pytest.approx(at_sixty_degrees, rel=1e-9)
        assert TIP_FACTOR * k / math.sqrt(found) >= mean


def test_the_rated_length_has_no_kink_where_it_reaches_the_critical_distance() -> None:
    distance = np.linspace(3.0, 30.0, 20_001)
    slope = np.diff(rated(distance)) / np.diff(distance)
    # min(2.4 r, l_0) would jump from 2.4 to 0 between two of these.
    assert np.abs(np.diff(slope)).max() < 0.02


def test_critical_distance_is_objective_at_the_crack_and_a_fatigue_limit_far_away() -> None:
    law = replace(CRITICAL_DISTANCE, values=(("critical_distance", 15.0),))
    damage = replace(DAMAGE, law=law)
    length, kinds = np.array([2.0, 2.0, 7.0]), np.zeros(3, dtype=int)
    distance = np.array([1.0, 1e6, 1e6])
    interfaces = damage_interfaces(length, kinds, damage, STATE, 0.0, crack_distance=distance)
    found = law.rate_constants(interfaces, damage)
    at_tip = constants_of(length[:1], kinds[:1], DAMAGE, STATE)
    assert found.factor[0] == at_tip.factor[0]
    assert found.threshold[0] == at_tip.threshold[0]
    limit = TIP_FACTOR * STATE.delta_k_th / math.sqrt(15.0)
    assert found.threshold[1:] == pytest.approx([limit, limit], rel=1e-9)
    assert found.factor[1] == pytest.approx(found.factor[2], rel=1e-9)


def test_far_away_it_is_the_printed_law_at_the_reference_length() -> None:
    damage = replace(DAMAGE, law=CRITICAL_DISTANCE)
    one, kinds = np.array([4.0]), np.zeros(1, dtype=int)
    far = damage_interfaces(one, kinds, damage, STATE, 0.0, crack_distance=np.array([1e6]))
    found = CRITICAL_DISTANCE.rate_constants(far, damage)
    printed = constants_of(np.array([DAMAGE.reference_length]), kinds, PRINTED_DAMAGE, STATE)
    assert found.factor == pytest.approx(printed.factor, rel=1e-9)
    assert found.threshold == pytest.approx(printed.threshold, rel=1e-9)
