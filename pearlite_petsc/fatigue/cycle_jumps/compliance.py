"""Cycle jump of interfaces that soften together, borne out by the equilibrium at its end.

The interfaces about to break are coupled by the compliance of the body round them, so that one
block goes until the first of them breaks. The equilibrium there shows the stresses of all others,
whose damage is integrated between both ends; a break that it does not bear out is tried anew.
"""

from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.between_solves import damage_at_end
from pearlite_petsc.fatigue.course import Course, course_of
from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Situation, Trial, Trials
from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.fatigue.extrapolation import Extrapolation, snapped
from pearlite_petsc.fatigue.release import next_release
from pearlite_petsc.fatigue.softening import Softening

ABOUT_TO_BREAK = 0.99
"""Fraction of the failure damage that interfaces may come to which were not seen to soften."""

MOST_GAIN = 0.1
"""Damage that no other interface may gain in a block at the rate of its start."""

MOST_TRIES = 3
"""Solves until the breaks that end a block are those that the solve bears out."""

T = TypeVar("T")
Solves = Generator[Trial, FloatArray, T]


@dataclass(frozen=True, slots=True)
class Compliance:
    """Interfaces soften together until the first one has released its step of force or breaks.

    Attributes:
        delta_d: Largest fraction of its force that an interface may release.
    """

    delta_d: float

    def __call__(self, start: Situation) -> Trials:
        """Try blocks until one is borne out, and return it."""
        found = yield from coupled_block(start, self.delta_d)
        return None if found is None else found.block


@dataclass(frozen=True, slots=True, eq=False)
class CoupledBlock:
    """A block of coupled interfaces.

    Attributes:
        block: The block.
        change: By how much its last solve changed the damage at the end anywhere on this rank;
            None where there was no solve.
    """

    block: Block
    change: float | None


def coupled_block(start: Situation, delta_d: float) -> Solves[CoupledBlock | None]:
    """Run a block of interfaces that soften together; None where none has a rate. Collective.

    Args:
        start: The situation.
        delta_d: Largest fraction of its force that an interface may release.
    """
    drive = start.drive.with_sensitivity(start.stiffness_ratio)
    alone = Extrapolation(drive, delta_d, "compliance", start.least)
    if not np.isfinite(alone.longest):
        return None
    numbers = _softening_interfaces(start, alone)
    longest = _longest(start, alone.rate, numbers)
    undone = 0
    # Which of two nearly even interfaces breaks first may hang on the way there: then go half.
    for least_steps in (1.0, 2.0):
        limit = next_release(
            start.damage, start.stiffness_ratio, start.failure_damage, delta_d, least_steps
        )
        softening = start.coupling.softening(
            numbers, drive, start.jump, start.stiffness_ratio, limit
        )
        foreseen = course_of(softening, longest)
        if foreseen.cycles[-1] == 0.0:
            # Whatever leads relieves itself at once: let each soften alone.
            damage = alone.damage_after(alone.longest)
            return CoupledBlock(Block(alone.longest, damage, counts={"undone": undone}), None)
        forecast = _Forecast(start, drive, numbers, softening, foreseen, longest)
        found = yield from _borne_out(forecast, alone.rate)
        undone += found.undone
        if found.is_borne_out:
            break
    block = replace(found.coupled.block, counts={"undone": undone})
    return replace(found.coupled, block=block)


def _softening_interfaces(start: Situation, alone: Extrapolation) -> IntArray:
    """Return the numbers of the interfaces that soften in the block, the first to break included."""
    gain = alone.damage_after(alone.longest) - start.damage
    gain[alone.first] = 1.0
    return start.coupling.softening_interfaces(gain)


def _longest(start: Situation, rate: FloatArray, numbers: IntArray) -> float:
    """Return the cycles until another interface would count as softening too. Collective."""
    others = start.coupling.with_values(numbers, rate, np.zeros(len(numbers)))
    most = float(others.max(initial=0.0))
    return start.least(MOST_GAIN / most if most > 0.0 else np.inf)


@dataclass(frozen=True, slots=True, eq=False)
class _Forecast:
    """How a block is thought to go: interfaces that soften together, and their course."""

    start: Situation
    drive: Drive
    numbers: IntArray
    softening: Softening
    course: Course
    longest: float

    @property
    def cycles(self) -> float:
        return float(self.course.cycles[-1])

    def trial(self, others: FloatArray) -> Trial:
        """Return the block's end, the damage of all others given (k,).

        Of those none breaks: what is about to comes first in the next block.
        """
        start = self.start
        most = np.maximum(start.damage, ABOUT_TO_BREAK * start.failure_damage)
        others = np.clip(others, start.damage, most)
        damage = start.coupling.with_values(self.numbers, others, self.course.damage[-1])
        return Trial(self.cycles, np.minimum(snapped(damage, start.failure_damage), 1.0))

    def corrected(self, trial: Trial, jump: FloatArray, foreseen: Course) -> "_Forecast":
        """Return the forecast after a solve at a trial; ``foreseen`` knew of none."""
        values_of = self.start.coupling.values_of
        seen = (values_of(self.numbers, values) for values in (trial.damage, jump))
        softening = self.softening.corrected(*seen)
        course = foreseen
        if softening.correction is not None:
            course = course_of(softening, self.longest)
        return replace(self, softening=softening, course=course)

    def jump_at_end(self, jump: FloatArray) -> FloatArray:
        """Return the jumps of a solve, those of the softening interfaces moved to the end."""
        now = self.softening.jumps_at(self.course.damage[-1])
        return self.start.coupling.with_values(self.numbers, jump, now)


@dataclass(frozen=True, slots=True, eq=False)
class _Finding:
    """What the solves of a block found: the block, whether they agree, and trials undone."""

    coupled: CoupledBlock
    is_borne_out: bool
    undone: int


def _borne_out(forecast: _Forecast, rate: FloatArray) -> Solves[_Finding]:
    """Solve at the block's end until the solve bears out the breaks there. Collective.

    Args:
        forecast: Before any solve.
        rate: dD/dN of all interfaces at the start [1/cycle]; (k,).
    """
    start, foreseen = forecast.start, forecast.course
    # All others go on as they do until the solve tells more of them.
    trial = forecast.trial(start.damage + rate * forecast.cycles)
    for undone in range(MOST_TRIES):
        jump = yield trial
        forecast = forecast.corrected(trial, jump, foreseen)
        if forecast.cycles == 0.0:
            return _found(trial, trial, jump, undone)
        normal, shear = start.stresses(jump)
        end = forecast.trial(damage_at_end(forecast.drive, normal, shear, forecast.course))
        if _breaks_the_same(start, trial, end):
            return _found(end, trial, forecast.jump_at_end(jump), undone)
        solved, trial = trial, end
    found = _found(solved, trial, jump, MOST_TRIES)
    return replace(found, is_borne_out=False)


def _found(end: Trial, other: Trial, jump: FloatArray, undone: int) -> _Finding:
    change = float(np.abs(end.damage - other.damage).max(initial=0.0))
    block = Block(end.cycles, end.damage, jump)
    return _Finding(CoupledBlock(block, change), is_borne_out=True, undone=undone)


def _breaks_the_same(start: Situation, one: Trial, other: Trial) -> bool:
    same = np.array_equal(one.damage >= 1.0, other.damage >= 1.0)
    return start.greatest(0.0 if same else 1.0) == 0.0
