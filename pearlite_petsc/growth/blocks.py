"""Damage on a domain, block of cycles by block, each one checked by the solve at its end."""

from collections import Counter
from collections.abc import Callable, Mapping

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.errors import SolverError
from pearlite_petsc.fatigue.cycle_jump import (
    Block,
    Drive,
    Memory,
    next_release,
    own_share,
    released,
    snapped,
)
from pearlite_petsc.fatigue.look_back import damage_after
from pearlite_petsc.fatigue.softening import Course, course_of
from pearlite_petsc.growth.coupling import Coupling
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.scene import Scene, State

SHORTEST_BLOCK = 0.01
"""Least share of its force that ``adaptive`` lets an interface release in a block."""

ABOUT_TO_BREAK = 0.99
"""Share of the failure damage that interfaces may come to which were not seen to soften."""

MOST_GAIN = 0.1
"""Damage that no other interface may gain in a block at the rate of its start."""

MOST_TRIES = 3
"""Solves until the breaks that end a block are those that the solve bears out."""

_MEMORY = ("sensitivity", "damage", "value")


Solve = Callable[[FloatArray], FloatArray]
"""Damage (k,) -> jumps of this rank's interfaces in equilibrium [um, um, rad]; (k, 3)."""

CutsThrough = Callable[[IntArray], bool]
"""Breaks, by local number -> whether they bring the crack to the window's edge, where no
equilibrium need exist.
"""


class Blocks:
    """Runs the blocks of one domain. Collective over its group.

    Args:
        scene, state: Damage constants, cycle jump, strength.
        domain: The domain; its damage and failure cycles follow the blocks.
        coupling: What couples its interfaces.
        cycles: N so far.

    Attributes:
        cycles: N.
        fresh: Interfaces of this rank that the last block broke.
        is_solved: Whether the jumps known are those of the present damage.
        counters: Blocks whose end was tried anew ("undone") or made shorter ("rejected").
    """

    def __init__(
        self, scene: Scene, state: State, domain: Domain, coupling: Coupling, cycles: float
    ) -> None:
        self.domain, self.cycles = domain, cycles
        self.counters: Counter[str] = Counter()
        self.fresh = np.empty(0, dtype=np.int64)
        self.is_solved = False
        self._jump: FloatArray | None = None
        self._damage, self._cycle_jump = scene.damage, scene.cycle_jump
        self._method = scene.cycle_jump.method
        self._law = domain.law(state)
        self._coupling = coupling
        part = domain.part
        self._memory = Memory(self._method, len(domain.damage))
        self._share = own_share(part.stiffness.k_n * part.length / scene.material.youngs_modulus)
        self._delta_d = self._cycle_jump.delta_d

    def advance(self, solve: Solve, cuts_through: CutsThrough) -> bool:
        """Run the next block; False where no interface has a rate (arrest). Collective.

        Args:
            solve, cuts_through: What blocks of coupled interfaces ask at their end; collective.
        """
        if self._method in ("compliance", "adaptive"):
            return self._advance_coupled(solve, cuts_through)
        drive = self._memory.learned(self.drive())
        block = Block(drive, self._delta_d, self._memory.curve, self._least)
        cycles = block.longest
        if not np.isfinite(cycles):
            return False
        damage = block.damage_after(cycles)
        if self._method == "heun":
            cycles, damage = self._heun(block, cycles, damage, solve)
        self._end(cycles, damage)
        self.is_solved = False
        return True

    def see(self, jump: FloatArray) -> None:
        """Take the jumps of a solve at the present damage [um, um, rad]; (k, 3)."""
        self._jump, self.is_solved = jump, True

    def drive(self) -> Drive:
        """Return what drives the interfaces now."""
        assert self._jump is not None
        return self._drive_of(self.domain.damage, self._jump)

    def released(self, damage: FloatArray) -> FloatArray:
        """Return the share of its force that each interface has let go, 1 where broken; (k,)."""
        return released(damage, self._share)

    def forget_near(self, points: FloatArray, reach: float) -> None:
        """Forget what was learned within reach [um] of breaks at some points [um]; (b, 2)."""
        self._memory.forget_near(self.domain.part.midpoint, points, reach)

    def by_interface(self) -> dict[str, FloatArray]:
        """Return all that goes on with the interfaces, by name; (k,) or (k, 3) each."""
        found = {"memory_" + name: getattr(self._memory, name) for name in _MEMORY}
        return found if self._jump is None else found | {"jump": self._jump}

    def numbers(self) -> dict[str, float]:
        """Return all else that going on needs."""
        solved = float(self.is_solved)
        return {"cycles": self.cycles, "delta_d": self._delta_d, "is_solved": solved}

    def resume(self, numbers: Mapping[str, float], arrays: Mapping[str, FloatArray]) -> None:
        """Go on from what ``numbers`` and ``by_interface`` returned; ``arrays`` of this rank."""
        self._delta_d = numbers["delta_d"]
        if "jump" in arrays:
            self._jump, self.is_solved = arrays["jump"], bool(numbers["is_solved"])
        for name in _MEMORY:
            if "memory_" + name in arrays:
                setattr(self._memory, name, arrays["memory_" + name])

    def _advance_coupled(self, solve: Solve, cuts_through: CutsThrough) -> bool:
        """Run a block of interfaces that soften together; False where none has a rate."""
        assert self._jump is not None
        start = self.drive().with_sensitivity(self._share)
        least_steps = 1.0
        while True:
            alone = Block(start, self._delta_d, "compliance", self._least)
            if not np.isfinite(alone.longest):
                return False
            gain = alone.damage_after(alone.longest) - start.damage
            gain[alone.first] = 1.0
            front = self._coupling.front(gain)
            limit = next_release(start, self._delta_d, least_steps)
            softening = self._coupling.softening(front, start, self._jump, self._share, limit)
            longest = self._longest(alone.rate, front)
            course = uncorrected = course_of(softening, longest)
            if course.cycles[-1] == 0.0:
                # Whatever leads relieves itself at once: let each soften alone.
                self._end(alone.longest, alone.damage_after(alone.longest))
                self.is_solved = False
                return True
            # All others go on as they do until the solve tells more of them.
            others = start.damage + alone.rate * course.cycles[-1]
            trial = self._end_of(start, others, front, course)
            if self._cuts(cuts_through, float(course.cycles[-1]), trial):
                self._end(float(course.cycles[-1]), trial)
                return True
            for _ in range(MOST_TRIES):
                jump, cycles = solve(trial), float(course.cycles[-1])
                seen = (self._coupling.of_front(front, values) for values in (trial, jump))
                softening = softening.corrected(*seen)
                course = course_of(softening, longest) if softening.is_corrected else uncorrected
                if course.cycles[-1] == 0.0:
                    found = trial
                    break
                others = damage_after(start, *self.domain.stresses(jump), course)
                found = self._end_of(start, others, front, course)
                spent = float(course.cycles[-1])
                if self._breaks_the_same(trial, found) or self._cuts(cuts_through, spent, found):
                    cycles, now = spent, softening.jumps_at(course.damage[-1])
                    jump = self._coupling.with_front(front, jump, now)
                    break
                self.counters["undone"] += 1
                trial, found = found, trial
            else:
                # Which of two nearly even interfaces breaks first hangs on the way there: go half.
                if least_steps == 1.0:
                    least_steps = 2.0
                    continue
            if self._method == "adaptive" and self._rejects(trial, found):
                continue
            self._jump = jump
            self._end(cycles, found)
            return True

    def _longest(self, rate: FloatArray, front: IntArray) -> float:
        """Return the cycles until an interface beside the front ones would count too. Collective."""
        others = self._coupling.with_front(front, rate, np.zeros(len(front)))
        most = float(others.max(initial=0.0))
        return self._least(MOST_GAIN / most if most > 0.0 else np.inf)

    def _end_of(
        self, start: Drive, others: FloatArray, front: IntArray, course: Course
    ) -> FloatArray:
        """Return the damage at the end of a course, that of all others given; (k,).

        Of those none breaks: what is about to comes first in the next block.
        """
        most = np.maximum(start.damage, ABOUT_TO_BREAK * start.failure_damage)
        others = np.clip(others, start.damage, most)
        damage = self._coupling.with_front(front, others, course.damage[-1])
        return np.minimum(snapped(damage, start.failure_damage), 1.0)

    def _broken_by(self, damage: FloatArray) -> IntArray:
        """Return the interfaces of this rank that a new damage breaks."""
        return np.flatnonzero((damage >= 1.0) & (self.domain.damage < 1.0))

    def _breaks_the_same(self, one: FloatArray, other: FloatArray) -> bool:
        same = np.array_equal(one >= 1.0, other >= 1.0)
        return bool(self.domain.comm.allreduce(same, MPI.LAND))

    def _cuts(self, cuts_through: CutsThrough, cycles: float, damage: FloatArray) -> bool:
        """Return whether a new damage brings the crack to the window's edge. Collective."""
        try:
            return cuts_through(self._broken_by(damage))
        except SolverError:
            # The message that names the cycle is that of the break.
            self.cycles += cycles
            raise

    def _end(self, cycles: float, damage: FloatArray) -> None:
        self.cycles += cycles
        self.fresh = self._broken_by(damage)
        self.domain.failure_cycles[self.fresh] = self.cycles
        self.domain.damage = damage

    def _drive_of(self, damage: FloatArray, jump: FloatArray) -> Drive:
        nominal = self._damage.stress == "nominal"
        failure = self._damage.failure_damage if nominal else 1.0
        normal, shear = (stress * (damage < 1.0) for stress in self.domain.stresses(jump))
        return Drive(damage, normal, shear, self._law, failure, nominal)

    def _rejects(self, trial: FloatArray, found: FloatArray) -> bool:
        """Choose the next block's length by what the solve changed; True where it is too much."""
        tolerance = self._cycle_jump.tolerance
        change = float(np.abs(found - trial).max(initial=0.0))
        change = max(self.domain.comm.allreduce(change, MPI.MAX), 1e-3 * tolerance)
        tried = self._delta_d
        self._delta_d *= float(np.clip(0.9 * np.sqrt(tolerance / change), 0.3, 2.0))
        self._delta_d = min(max(self._delta_d, SHORTEST_BLOCK), 1.0)
        if change <= tolerance or tried <= SHORTEST_BLOCK:
            return False
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
        intact = self.domain.damage < 1.0
        trial = np.where(intact, np.minimum(damage, 0.999), 1.0)
        end = self._drive_of(trial, solve(trial)).rate_at(trial)
        mean = 0.5 * (block.rate + end) * intact
        room = block.drive.failure_damage - self.domain.damage
        straight = np.divide(room, mean, where=mean > 0.0, out=np.full(len(mean), np.inf))
        cycles = min(cycles, self._least(float(straight.min(initial=np.inf))))
        return cycles, snapped(self.domain.damage + mean * cycles, block.drive.failure_damage)

    def _least(self, value: float) -> float:
        return float(self.domain.comm.allreduce(value, MPI.MIN))
