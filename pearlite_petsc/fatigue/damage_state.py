"""Where the damage of a mesh's interfaces stands between two blocks of cycles."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Memory
from pearlite_petsc.scene import Kind


@dataclass(frozen=True, slots=True, eq=False)
class DamageState:
    """Damage, its history and what is known of the next block.

    Attributes:
        cycles: N.
        damage: D, 1 where broken and for the notch's interfaces; (k,).
        failure_cycles: N at which they broke, NaN before, 0 the notch's; (k,).
        jump: Jumps of the last solve [um, um, rad], None before the first; (k, 3).
        is_solved: Whether those jumps are in equilibrium at this damage.
        memory: What the cycle jump remembers.
    """

    cycles: float
    damage: FloatArray
    failure_cycles: FloatArray
    jump: FloatArray | None
    is_solved: bool
    memory: Memory

    def broken_by(self, damage: FloatArray) -> IntArray:
        """Return the interfaces that a new damage (k,) breaks.

        >>> notched(np.array([Kind.NOTCH, Kind.LAMELLA])).broken_by(np.ones(2)).tolist()
        [1]
        """
        return np.flatnonzero((damage >= 1.0) & (self.damage < 1.0))

    def after(self, block: Block) -> "DamageState":
        """Return the state at the end of a block."""
        cycles = self.cycles + block.cycles
        failure_cycles = self.failure_cycles.copy()
        failure_cycles[self.broken_by(block.damage)] = cycles
        return DamageState(
            cycles,
            block.damage,
            failure_cycles,
            self.jump if block.jump is None else block.jump,
            block.jump is not None,
            block.memory,
        )

    def solved(self, jump: FloatArray) -> "DamageState":
        """Return the state with the jumps in equilibrium at its damage [um, um, rad]; (k, 3)."""
        return replace(self, jump=jump, is_solved=True)

    def unsolved(self) -> "DamageState":
        """Return the state of which nothing is known by interface but the damage."""
        memory = Memory(numbers=self.memory.numbers)
        return replace(self, jump=None, is_solved=False, memory=memory)

    def forgotten(self, near: BoolArray) -> "DamageState":
        """Return the state whose cycle jump has forgotten what it knew of some interfaces; (k,)."""
        known = {
            name: np.where(near, np.nan, values)
            for name, values in self.memory.by_interface.items()
        }
        return replace(self, memory=replace(self.memory, by_interface=known))

    def on_interfaces(self, change: Callable[[FloatArray], FloatArray]) -> "DamageState":
        """Return the state with every array changed; called for each in one order."""
        known = {name: change(values) for name, values in self.memory.by_interface.items()}
        return replace(
            self,
            damage=change(self.damage),
            failure_cycles=change(self.failure_cycles),
            jump=None if self.jump is None else change(self.jump),
            memory=replace(self.memory, by_interface=known),
        )


def notched(kind: IntArray) -> DamageState:
    """Return the start: all interfaces intact but those of the notch.

    Args:
        kind: Kind of each interface; (k,).
    """
    notch = kind == Kind.NOTCH
    failure_cycles = np.where(notch, 0.0, np.nan)
    return DamageState(0.0, notch.astype(float), failure_cycles, None, False, Memory())
