"""The state of damage between two blocks: a value that each block replaces by another."""

import numpy as np
import pytest

from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Memory
from pearlite_petsc.fatigue.damage_state import DamageState, notched
from pearlite_petsc.scene import Kind

KIND = np.array([Kind.NOTCH, Kind.LAMELLA, Kind.CEMENTITE, Kind.COLONY])
JUMP = np.arange(12.0).reshape(4, 3)


def grown() -> DamageState:
    memory = Memory({"rate": np.array([1.0, 2.0, 3.0, 4.0])}, {"delta_d": 0.3})
    return notched(KIND).after(Block(100.0, np.array([1.0, 0.2, 1.0, 0.0]), JUMP, memory))


def test_only_the_notch_is_broken_at_the_start() -> None:
    start = notched(KIND)
    assert start.damage.tolist() == [1.0, 0.0, 0.0, 0.0]
    assert start.failure_cycles[0] == 0.0 and np.isnan(start.failure_cycles[1:]).all()
    assert start.cycles == 0.0 and start.jump is None and not start.is_solved


def test_a_block_notes_when_each_interface_broke() -> None:
    once = grown()
    twice = once.after(Block(50.0, np.array([1.0, 1.0, 1.0, 0.1])))
    assert twice.cycles == 150.0
    assert twice.failure_cycles[:3].tolist() == [0.0, 150.0, 100.0]
    assert np.isnan(twice.failure_cycles[3])
    # The state of before is as it was.
    assert np.isnan(once.failure_cycles[1])
    assert once.broken_by(twice.damage).tolist() == [1]


def test_a_block_without_jumps_keeps_the_last_ones_and_asks_for_a_solve() -> None:
    solved = grown()
    assert solved.is_solved and solved.jump is JUMP
    after = solved.after(Block(1.0, solved.damage))
    assert not after.is_solved and after.jump is JUMP
    assert after.solved(2.0 * JUMP).is_solved


def test_what_is_near_a_break_is_forgotten_and_nothing_else() -> None:
    forgotten = grown().forgotten(np.array([False, True, False, True]))
    rate = forgotten.memory.by_interface["rate"]
    assert np.isnan(rate).tolist() == [False, True, False, True]
    assert rate[[0, 2]].tolist() == [1.0, 3.0]
    assert forgotten.memory.numbers == {"delta_d": 0.3}


def test_another_mesh_knows_the_numbers_but_nothing_by_interface() -> None:
    fresh = grown().unsolved()
    assert fresh.jump is None and not fresh.is_solved
    assert not fresh.memory.by_interface and fresh.memory.numbers == {"delta_d": 0.3}
    assert fresh.cycles == 100.0


def test_every_array_of_interfaces_is_changed() -> None:
    changed = grown().on_interfaces(lambda values: values[::-1])
    assert changed.damage.tolist() == [0.0, 1.0, 0.2, 1.0]
    assert changed.failure_cycles[1] == 100.0
    assert changed.jump == pytest.approx(JUMP[::-1])
    assert changed.memory.by_interface["rate"].tolist() == [4.0, 3.0, 2.0, 1.0]
