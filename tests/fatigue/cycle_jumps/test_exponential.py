import numpy as np
import pytest

from pearlite_petsc.fatigue.cycle_jumps.exponential import UNKNOWN_EXPONENT, Exponential, exponent
from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Memory
from tests.fatigue.cycle_jumps.body import COUNT, Body


def test_the_exponent_is_found_again_from_two_rates() -> None:
    damage, before = np.array([0.3, 0.3, 0.105]), np.array([0.1, 0.1, 0.1])
    rate = 1e-3 * np.exp(4.0 * (damage - before))
    found = exponent(rate, np.array([1e-3, 0.0, 1e-3]), damage, before)
    assert found[0] == pytest.approx(4.0)
    # No rate before, or hardly any damage since: nothing is learned.
    assert np.isnan(found[1:]).all()


def test_what_is_forgotten_starts_from_the_unknown_exponent_again() -> None:
    body = Body()
    first = Exponential(0.1)(body.situation(np.zeros(COUNT)))
    assert isinstance(first, Block)
    assert first.memory.by_interface["exponent"].tolist() == [UNKNOWN_EXPONENT] * COUNT
    second = Exponential(0.1)(body.situation(first.damage, memory=first.memory))
    assert isinstance(second, Block)
    leader = int(np.argmax(second.damage))
    learned = second.memory.by_interface["exponent"]
    assert learned[leader] != UNKNOWN_EXPONENT
    known = {name: values.copy() for name, values in second.memory.by_interface.items()}
    for values in known.values():
        values[leader] = np.nan
    third = Exponential(0.1)(body.situation(second.damage, memory=Memory(known)))
    assert isinstance(third, Block)
    assert third.memory.by_interface["exponent"][leader] == UNKNOWN_EXPONENT
