"""One interface in series with a spring lives as long as its closed forms say."""

import numpy as np
import pytest

from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.fatigue.lone_interface import LoneInterface
from pearlite_petsc.laws import CycleJumpLaw, RateConstants
from pearlite_petsc.scene import CycleJump
from pearlite_petsc.studies.law_claims.exact_life import exact_life

FREE = RateConstants(np.array([1e-12]), np.zeros(1), 0.3)


def settings(method: str, delta_d: float) -> CycleJump:
    return CycleJump(SHIPPED.named(CycleJumpLaw, method), delta_d, 0.02)


def test_under_a_constant_stress_the_life_is_one_over_the_rate() -> None:
    interface = LoneInterface(FREE, 1000.0, 0.0, 0.0)
    assert interface.rate(0.5) == interface.rate(0.0) == pytest.approx(1e-3, rel=1e-12)
    assert interface.life(settings("euler", 0.25)) == pytest.approx(1e3, rel=1e-12)
    assert len(interface.blocks(settings("euler", 0.25))) == 4
    assert len(interface.blocks(settings("euler", 0.25), most=2)) == 2


def test_as_it_softens_the_life_is_the_integral_in_closed_form() -> None:
    g = 0.7
    interface = LoneInterface(FREE, 1000.0, 300.0, g)
    life = (1.0 - (1.0 - g) ** 4) / (4.0 * g * interface.rate(0.0))
    assert exact_life(interface) == pytest.approx(life, rel=1e-9)
    assert interface.life(settings("compliance", 1.0)) == pytest.approx(life, rel=2e-3)
    assert interface.life(settings("heun", 0.02)) == pytest.approx(life, rel=1e-3)


def test_what_has_no_rate_lives_for_ever() -> None:
    held = RateConstants(np.array([1e-12]), np.array([1e4]), 0.3)
    assert LoneInterface(held, 1000.0, 0.0, 0.5).life(settings("compliance", 1.0)) == np.inf
