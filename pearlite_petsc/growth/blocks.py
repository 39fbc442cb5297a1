"""Damage on a domain, block of cycles by block, with a look back at each from the solve after it."""

from collections import Counter
from collections.abc import Callable, Mapping

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.cycle_jump import (
    Block,
    Drive,
    Memory,
    own_share,
    released,
    snapped,
)
from pearlite_petsc.fatigue.look_back import Course, course_of, damage_after, leading_share
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.scene import Scene, State

Solve = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Damage (k,) -> effective normal and shear stress [MPa]; (k,) each."""

SHORTEST_BLOCK = 0.01
"""Least damage increment that ``adaptive`` tries."""

_PASSES = 2
_LAST = ("damage", "normal", "shear", "leading")
_MEMORY = ("sensitivity", "damage", "value")


class Blocks:
    """Runs the blocks of one domain. Collective over its group.

    Args:
        scene, state: Damage constants, cycle jump, strength.
        domain: The domain; its damage and failure cycles follow the blocks.
        cycles: N so far.

    Attributes:
        cycles: N, provisional until the solve after the block has been seen.
        fresh: Interfaces of this rank that the last change of damage broke.
        revised: N before and after the last look back.
        counters: Blocks that ``adaptive`` rejected.
    """

    def __init__(self, scene: Scene, state: State, domain: Domain, cycles: float) -> None:
        self.domain, self.cycles = domain, cycles
        self.counters: Counter[str] = Counter()
        self.revised = (cycles, cycles)
        self.fresh = np.empty(0, dtype=np.int64)
        self._damage, self._jump = scene.damage, scene.cycle_jump
        self._law = domain.law(state)
        part = domain.part
        stiffness = part.stiffness.k_n * part.length / scene.material.youngs_modulus
        self._memory = Memory(self._jump.method, domain.damage, stiffness)
        # Not what the memory has learned: where the load is must not depend on the method.
        self._own_share = own_share(stiffness)
        self._delta_d = self._jump.delta_d
        # The last block, whose end has not been seen: N and, by interface, damage and stresses at
        # its start and a mark on the interface that ended it.
        self._last_cycles = float("nan")
        self._last: dict[str, FloatArray] = {}

    @property
    def is_provisional(self) -> bool:
        """Whether the last block still waits for the solve after it."""
        return bool(self._last)

    def see(self, normal: FloatArray, shear: FloatArray) -> bool:
        """Take the stresses of a solve and look back at the block before; True if more broke.

        Where ``adaptive`` finds that block too long and nothing has broken in it, it is undone and
        a shorter one will follow. Collective.

        Args:
            normal, shear: Effective stresses, broken interfaces included [MPa]; (k,).
        """
        self._normal, self._shear = normal, shear
        last, self._last = self._last, {}
        if not last:
            return False
        start = self._drive_of(last["damage"], last["normal"], last["shear"])
        course = self._course(start, last["leading"])
        if course is None:
            return False
        within = start.damage < 1.0
        present, found = self.domain.damage, self.domain.damage
        for _ in range(_PASSES):
            # The end's stresses were solved at the damage that the block had foreseen.
            softening = self._memory.softening(present, found) * within
            found = damage_after(start, normal * softening, shear * softening, course)
            known = (present >= 1.0) | (last["leading"] > 0.0)
            found = np.where(known, present, np.minimum(found, 1.0))
        if self._jump.method == "adaptive" and self._rejects(found, start):
            return False
        before, self.cycles = self.cycles, self._last_cycles + float(course.cycles[-1])
        self.revised = before, self.cycles
        failure_cycles = self.domain.failure_cycles
        failure_cycles[failure_cycles == before] = self.cycles
        softening = self._memory.softening(present, found)
        self._normal, self._shear = normal * softening, shear * softening
        self._set_damage(snapped(found, start.failure_damage))
        return bool(self.domain.comm.allreduce(len(self.fresh) > 0, MPI.LOR))

    def advance(self, solve: Solve) -> bool:
        """Run the next block; False where no interface has a rate (arrest). Collective.

        Args:
            solve: Returns the stresses at a damage; ``heun`` needs them.
        """
        drive = self._memory.learned(self.drive())
        block = Block(drive, self._delta_d, self._memory.curve, self._least)
        cycles = block.longest
        if not np.isfinite(cycles):
            return False
        damage = block.damage_after(cycles)
        if self._jump.method == "heun":
            cycles, damage = self._heun(block, cycles, damage, solve)
        if self._memory.curve == "compliance":
            leading = np.zeros(len(damage))
            leading[block.first] = 1.0
            values = (drive.damage, drive.normal, drive.shear, leading)
            self._last = dict(zip(_LAST, values, strict=True))
            self._last_cycles = self.cycles
        self.cycles += cycles
        self._set_damage(damage)
        return True

    def drive(self) -> Drive:
        """Return what drives the interfaces now."""
        intact = self.domain.damage < 1.0
        return self._drive_of(self.domain.damage, self._normal * intact, self._shear * intact)

    def released(self, damage: FloatArray) -> FloatArray:
        """Return the share of its force that each interface has let go, 1 where broken; (k,)."""
        return released(damage, self._own_share)

    def forget_near(self, points: FloatArray, reach: float) -> None:
        """Forget what was learned within reach [um] of breaks at some points [um]; (b, 2)."""
        self._memory.forget_near(self.domain.part.midpoint, points, reach)

    def by_interface(self) -> dict[str, FloatArray]:
        """Return all that goes on with the interfaces, by name; (k,) each."""
        memory = {"memory_" + name: getattr(self._memory, name) for name in _MEMORY}
        last = {"last_" + name: values for name, values in self._last.items()}
        return memory | last

    def numbers(self) -> dict[str, float]:
        """Return all else that going on needs."""
        return {
            "cycles": self.cycles,
            "last_cycles": self._last_cycles,
            "delta_d": self._delta_d,
            "surroundings": self._memory.surroundings,
        }

    def resume(self, numbers: Mapping[str, float], arrays: Mapping[str, FloatArray]) -> None:
        """Go on from what ``numbers`` and ``by_interface`` returned; ``arrays`` of this rank."""
        self._last_cycles, self._delta_d = numbers["last_cycles"], numbers["delta_d"]
        self._memory.restart(numbers["surroundings"])
        for name in _MEMORY:
            if "memory_" + name in arrays:
                setattr(self._memory, name, arrays["memory_" + name])
        self._last = {name: arrays["last_" + name] for name in _LAST if "last_" + name in arrays}

    def _set_damage(self, damage: FloatArray) -> None:
        domain = self.domain
        self.fresh = np.flatnonzero((damage >= 1.0) & (domain.damage < 1.0))
        domain.failure_cycles[self.fresh] = self.cycles
        domain.damage = damage

    def _drive_of(self, damage: FloatArray, normal: FloatArray, shear: FloatArray) -> Drive:
        nominal = self._damage.stress == "nominal"
        failure = self._damage.failure_damage if nominal else 1.0
        return Drive(damage, normal, shear, self._law, failure, nominal)

    def _course(self, start: Drive, leading: FloatArray) -> Course | None:
        """Return how the last block went for its leading interface, on all ranks. Collective."""
        mine: tuple[float, float, Course] | None = None
        for number in np.flatnonzero(leading)[:1]:
            before, after = (
                float(np.hypot(max(normal[number], 0.0), shear[number]))
                for normal, shear in ((start.normal, start.shear), (self._normal, self._shear))
            )
            end = float(self.domain.damage[number])
            if before > 0.0:
                share = leading_share(before, after, float(start.damage[number]), end)
                limit = min(end, start.failure_damage)
                course = course_of(start.take(np.array([number])), share, limit)
                mine = share, float(self._memory.stiffness[number]), course
        everyone: list[tuple[float, float, Course] | None] = self.domain.comm.allgather(mine)
        for found in everyone:
            if found is not None:
                share, stiffness, course = found
                self._memory.observe(share, stiffness, leading > 0.0)
                return course
        return None

    def _rejects(self, found: FloatArray, start: Drive) -> bool:
        """Choose the next block's length from what the look back changed; undo this one if bad."""
        comm, tolerance = self.domain.comm, self._jump.tolerance
        change = float(np.abs(found - self.domain.damage).max(initial=0.0))
        change = max(comm.allreduce(change, MPI.MAX), 1e-3 * tolerance)
        broke = comm.allreduce(
            bool(((self.domain.damage >= 1.0) & (start.damage < 1.0)).any()), MPI.LOR
        )
        self._delta_d *= float(np.clip(0.9 * np.sqrt(tolerance / change), 0.3, 2.0))
        self._delta_d = min(max(self._delta_d, SHORTEST_BLOCK), 1.0)
        if broke or change <= tolerance or self._delta_d == SHORTEST_BLOCK:
            return False
        self.cycles = self._last_cycles
        self._set_damage(start.damage)
        self._normal, self._shear = start.normal, start.shear
        self.counters["rejected"] += 1
        return True

    def _heun(
        self,
        block: Block,
        cycles: float,
        damage: FloatArray,
        solve: Solve,
    ) -> tuple[float, FloatArray]:
        """Return the block repeated with the mean of the rates at its start and its end."""
        domain = self.domain
        intact = domain.damage < 1.0
        trial = np.where(intact, np.minimum(damage, 0.999), 1.0)
        normal, shear = solve(trial)
        end = self._drive_of(trial, normal * intact, shear * intact).rate_at(trial)
        mean = 0.5 * (block.rate + end) * intact
        room = block.drive.failure_damage - domain.damage
        straight = np.divide(room, mean, where=mean > 0.0, out=np.full(len(mean), np.inf))
        cycles = min(cycles, self._least(float(straight.min(initial=np.inf))))
        return cycles, snapped(domain.damage + mean * cycles, block.drive.failure_damage)

    def _least(self, value: float) -> float:
        return float(self.domain.comm.allreduce(value, MPI.MIN))
