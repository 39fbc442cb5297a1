"""Damage on a domain as it goes from block to block."""

from collections import Counter
from collections.abc import Mapping
from typing import TypeVar

import numpy as np
from mpi4py import MPI
from scipy.spatial.distance import cdist

from pearlite_petsc.arrays import FloatArray, IntArray, read_only
from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Memory, Situation
from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.fatigue.release import released, stiffness_ratio
from pearlite_petsc.growth.coupling import Coupling
from pearlite_petsc.growth.damage_rates import DamageRates
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.scene import Scene, State

T = TypeVar("T")

_BY_INTERFACE, _NUMBER = "memory_", "remembered_"


class Blocks:
    """Where the damage of one domain stands between two blocks.

    Args:
        scene, state: Damage constants, strength.
        domain: The domain; its damage and failure cycles follow the blocks.
        coupling: What couples its interfaces.
        cycles: N so far.

    Attributes:
        cycles: N.
        fresh: Interfaces of this rank that the last block broke.
        is_solved: Whether the jumps known are those of the present damage.
        memory: What the cycle jump remembers.
        counters: What happened in the blocks so far ("undone", "rejected").
    """

    def __init__(
        self, scene: Scene, state: State, domain: Domain, coupling: Coupling, cycles: float
    ) -> None:
        self.domain, self.cycles = domain, cycles
        self.counters: Counter[str] = Counter()
        self.fresh = np.empty(0, dtype=np.int64)
        self.is_solved = False
        self.memory = Memory()
        self._jump: FloatArray | None = None
        self._rates = DamageRates(domain, state)
        self._coupling = coupling
        self._nominal = scene.damage.stress == "nominal"
        self._failure_damage = scene.damage.failure_damage if self._nominal else 1.0
        # How far a break changes the stresses much [um].
        self._reach = 2.0 * max(scene.elements.width, scene.elements.length)
        subdomain, modulus = domain.subdomain, scene.material.youngs_modulus
        self._stiffness_ratio = stiffness_ratio(
            subdomain.stiffness.k_n * subdomain.length / modulus
        )

    def situation(self) -> Situation:
        """Return what the next block starts from."""
        assert self._jump is not None
        comm = self.domain.comm
        return Situation(
            damage=self.domain.damage,
            jump=self._jump,
            stiffness=self.domain.subdomain.stiffness,
            law=self._rates.constants,
            failure_damage=self._failure_damage,
            nominal=self._nominal,
            stiffness_ratio=self._stiffness_ratio,
            coupling=self._coupling,
            memory=self.memory,
            least=lambda value: float(comm.allreduce(value, MPI.MIN)),
            greatest=lambda value: float(comm.allreduce(value, MPI.MAX)),
        )

    def end(self, block: Block) -> None:
        """Go on to the end of a block."""
        self.cycles += block.cycles
        self.fresh = self.broken_by(block.damage)
        failure_cycles = self.domain.failure_cycles.copy()
        failure_cycles[self.fresh] = self.cycles
        self.domain.failure_cycles = read_only(failure_cycles)
        self.domain.damage = read_only(block.damage)
        self.memory = block.memory
        self.counters.update(block.counts)
        self.is_solved = block.jump is not None
        if block.jump is not None:
            self._jump = block.jump

    def broken_by(self, damage: FloatArray) -> IntArray:
        """Return the interfaces of this rank that a new damage breaks."""
        return np.flatnonzero((damage >= 1.0) & (self.domain.damage < 1.0))

    def see(self, jump: FloatArray) -> None:
        """Take the jumps of a solve at the present damage [um, um, rad]; (k, 3)."""
        self._jump, self.is_solved = jump, True

    def drive(self) -> Drive:
        """Return what drives the interfaces now."""
        return self.situation().drive

    def released(self, damage: FloatArray) -> FloatArray:
        """Return the fraction of its force that each interface has let go, 1 where broken; (k,)."""
        return released(damage, self._stiffness_ratio)

    def see_breaks(self, ends: FloatArray) -> None:
        """Take in what has broken, and forget what was learned close to it.

        Args:
            ends: Both ends of each interface that broke [um]; (b, 2, 2).
        """
        self._rates.see_breaks(ends)
        if self.memory.by_interface:
            points = ends.mean(axis=1)
            near = cdist(self.domain.subdomain.midpoint, points).min(axis=1) < self._reach
            known = {
                name: np.where(near, np.nan, values)
                for name, values in self.memory.by_interface.items()
            }
            self.memory = Memory(known, self.memory.numbers)

    def by_interface(self) -> dict[str, FloatArray]:
        """Return all that goes on with the interfaces, by name; (k,) or (k, 3) each."""
        remembered = self.memory.by_interface
        found = {_BY_INTERFACE + name: values for name, values in remembered.items()}
        return found if self._jump is None else found | {"jump": self._jump}

    def numbers(self) -> dict[str, float]:
        """Return all else that going on needs."""
        found = {_NUMBER + name: value for name, value in self.memory.numbers.items()}
        return found | {"cycles": self.cycles, "is_solved": float(self.is_solved)}

    def resume(self, numbers: Mapping[str, float], arrays: Mapping[str, FloatArray]) -> None:
        """Go on from what ``numbers`` and ``by_interface`` returned; ``arrays`` of this rank."""
        if "jump" in arrays:
            self._jump, self.is_solved = arrays["jump"], bool(numbers["is_solved"])
        self.memory = Memory(_without(_BY_INTERFACE, arrays), _without(_NUMBER, numbers))


def _without(prefix: str, values: Mapping[str, T]) -> dict[str, T]:
    """Return the values whose names have a prefix, by the rest of their names."""
    return {
        name.removeprefix(prefix): value
        for name, value in values.items()
        if name.startswith(prefix)
    }
