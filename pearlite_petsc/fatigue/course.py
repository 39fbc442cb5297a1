"""How interfaces that soften together go from the start of a block to the first limit."""

import math
from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.fatigue.softening import Softening

TOLERANCE = 1e-2
"""Error of a step in damage, and of its cycles over all cycles so far."""

_FIRST_STEP, _SHORTEST_STEP = 0.4, 1e-7
_MOST_TRIES = 500
# Bogacki and Shampine's third-order step, and its difference from the second-order one. Not scipy's:
# which interface's damage is the independent variable changes from step to step.
_STAGES = (np.array([1 / 2]), np.array([0.0, 3 / 4]), np.array([2 / 9, 1 / 3, 4 / 9]))
_ERROR = np.array([-5 / 72, 1 / 12, 1 / 9, -1 / 8])


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """How a block goes.

    Attributes:
        cycles: Since the block's start, ascending from 0 [cycles]; (m,).
        damage: Of the softening interfaces; (m, a).
        released: Fraction of the force let go in the block that is gone by then, 0 to 1; (m,).
        first: Interface that reached its limit, None where none did.
    """

    cycles: FloatArray
    damage: FloatArray
    released: FloatArray
    first: int | None


def course_of(softening: Softening, longest: float = math.inf) -> Course:
    """Return the way from the block's start until the first interface reaches its limit.

    The damage of the interface that leads is the independent variable, which keeps the integrand
    smooth where rates rise a hundredfold; steps of third order with an estimate of their error
    (Bogacki and Shampine).

    Args:
        softening: The interfaces.
        longest: Cycles after which the block may end without that, between half as many and these.
    """
    way = _Way(softening, longest)
    for _ in range(_MOST_TRIES):
        if not way.goes_on():
            break
    return way.course()


@dataclass(frozen=True, slots=True, eq=False)
class _Node:
    """Cycles since the block's start, and damage, jumps and rates then."""

    cycles: float
    damage: FloatArray
    jump: FloatArray
    rate: FloatArray


class _Way:
    """The nodes so far, and the step to be tried next."""

    def __init__(self, softening: Softening, longest: float) -> None:
        self._softening, self._longest = softening, longest
        rate = softening.rate_at(softening.damage, softening.jump)
        self._nodes = [_Node(0.0, softening.damage, softening.jump, rate)]
        self._relieved = np.zeros(len(rate), dtype=bool)
        self._step = _FIRST_STEP
        self._lead: int | None = None
        self._first: int | None = None

    def goes_on(self) -> bool:
        """Try a step; return whether another one is to be tried."""
        now = self._nodes[-1]
        room = self._softening.limit - now.damage
        if self._lead is None:
            self._lead = self._leading(now, room)
            if self._lead is None:
                return False
        lead = self._lead
        # Never the whole way at once, which would leave nothing to compare with.
        size = min(self._step, float(room[lead]) * (0.5 if len(self._nodes) == 1 else 1.0))
        after, error = _step(self._softening, now, lead, size)
        if after is None:
            self._shorten_without_rate(lead, size)
            return True
        gain = after.damage - now.damage
        over = gain > room * (1.0 + 1e-9)
        over[lead] = False
        if over.any():
            self._follow_the_first_of(over, room, gain)
            return True
        if after.cycles > self._longest:
            self._step = 0.9 * size * (self._longest - now.cycles) / (after.cycles - now.cycles)
            return not (now.cycles > 0.5 * self._longest or size < _SHORTEST_STEP)
        factor = 0.8 * (TOLERANCE / max(error, 1e-9)) ** (1.0 / 3.0)
        if error > TOLERANCE and size > _SHORTEST_STEP:
            self._step = size * max(factor, 0.2)
            return True
        if size == room[lead]:
            after.damage[lead] = self._softening.limit[lead]
            self._first = lead
        self._nodes.append(after)
        self._step, self._lead = size * min(factor, 4.0), None
        return self._first is None

    def course(self) -> Course:
        """Return the way that was gone."""
        let_go = self._softening.force_let_go
        cycles = np.array([node.cycles for node in self._nodes])
        damage = np.array([node.damage for node in self._nodes])
        forces = np.array([let_go(node.damage, node.jump) for node in self._nodes])
        whole = forces[-1]
        gone = forces / whole if whole > 0.0 else np.linspace(0.0, 1.0, len(forces))
        return Course(cycles, damage, gone, self._first)

    def _leading(self, now: _Node, room: FloatArray) -> int | None:
        """Return the interface that would be the first at its limit, None where none has a rate."""
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            time = np.where((now.rate > 0.0) & ~self._relieved, room / now.rate, np.inf)
        lead = int(np.argmin(time))
        return lead if np.isfinite(time[lead]) else None

    def _shorten_without_rate(self, lead: int, size: float) -> None:
        """Try a shorter step, or let another interface lead where this one relieves itself."""
        self._step = 0.3 * size
        if self._step < _SHORTEST_STEP:
            self._relieved[lead] = True
            self._step, self._lead = _FIRST_STEP, None

    def _follow_the_first_of(self, over: BoolArray, room: FloatArray, gain: FloatArray) -> None:
        """Let the interface lead that was the first to pass its limit in a step."""
        fraction = np.full(len(room), np.inf)
        np.divide(room, gain, out=fraction, where=over)
        self._lead = int(np.argmin(fraction))
        self._step = float(room[self._lead])


def _step(softening: Softening, start: _Node, lead: int, size: float) -> tuple[_Node | None, float]:
    """Return where a step in the damage of one interface leads, and the error made on the way.

    None where that interface has no rate at some point of the step.
    """
    # Damage of all and, in the last place, cycles; by the damage of the one.
    count = len(start.damage)
    slopes = np.empty((len(_ERROR), count + 1))
    slopes[0, :count], slopes[0, count] = start.rate, 1.0
    slopes[0] /= start.rate[lead]
    point = jump = rate = start.damage
    for row, weights in enumerate(_STAGES, 1):
        point = size * (weights @ slopes[:row])
        damage = np.minimum(start.damage + point[:count], 1.0)
        jump = softening.jumps_at(damage)
        rate = softening.rate_at(damage, jump)
        if not rate[lead] > 0.0:
            return None, 0.0
        slopes[row, :count], slopes[row, count] = rate, 1.0
        slopes[row] /= rate[lead]
    off = np.abs(size * (_ERROR @ slopes))
    cycles = start.cycles + float(point[count])
    error = max(float(off[:count].max()), float(off[count]) / cycles)
    return _Node(cycles, damage, jump, rate), error
