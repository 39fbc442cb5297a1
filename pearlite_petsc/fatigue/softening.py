"""Interfaces that soften together: their jumps at any damage, and the way to the next break.

The body outside a few interfaces is linear. With the compliance C of their jumps to pairs of
forces, each with its springs as they were at the damage D_0, the jumps at a damage D are

    (I - C diag(k (D - D_0))) jump = jump_0 + pull shift + residual,

exact as long as nothing else softens: ``shift`` is how far the load has followed the tip, ``pull``
what that does to the jumps. ``residual`` is what a solve at the end of a block finds beside it.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.linalg.lapack import dgesv

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.release import released
from pearlite_petsc.laws.damage import RateConstants

SOFTENING = 0.02
"""Share of its force from which an interface that lets go moves the load."""

TOLERANCE = 1e-2
"""Error of a step in damage, and of its cycles over all cycles so far."""

SMALL_RESIDUAL = 3e-3
"""Share of the jumps below which what a solve finds changes nothing."""

_FIRST_STEP, _SHORTEST_STEP = 0.4, 1e-7
_MOST_TRIES = 500
# Bogacki and Shampine's third-order step, and its difference from the second-order one.
_STAGES = (np.array([1 / 2]), np.array([0.0, 3 / 4]), np.array([2 / 9, 1 / 3, 4 / 9]))
_ERROR = np.array([-5 / 72, 1 / 12, 1 / 9, -1 / 8])

_Lengthening = tuple[tuple[int, float, float, float], ...]
# Number, g and advance [um] of the few interfaces that would lengthen the crack.


@dataclass(frozen=True, slots=True, eq=False)
class Softening:
    """A few interfaces at the start of a block, and what couples them.

    Attributes:
        damage: D_0, below the failure damage; (a,).
        limit: D at which the block ends for each; (a,).
        jump: Normal, tangential and rotational jump [um, um, rad]; (a, 3).
        constants: k_n l, k_t l, k_n l^3/12 of the intact springs; (a, 3).
        springs: k_n and k_t [MPa/um]; (a, 2).
        compliance: C, row and column 3 i + c for jump c of interface i; (3 a, 3 a).
        law: Rate constants.
        nominal: Whether (1 - D) times the effective stress drives the damage.
        share: g of each alone, by which its release of force moves the load; (a,).
        advance: Where the tip would go if it broke, from where it is [um]; (a, 2).
        centre: Of the load at D_0, from the tip [um]; (2,).
        pull: Jumps per um that the load moves in x and in y; (a, 3, 2).
        residual: What else the free jumps gain by the block's end; (a, 3).
        moment_end: ``moment`` at that end, 0 where there is no residual.
    """

    damage: FloatArray
    limit: FloatArray
    jump: FloatArray
    constants: FloatArray
    springs: FloatArray
    compliance: FloatArray
    law: RateConstants
    nominal: bool
    share: FloatArray
    advance: FloatArray
    centre: FloatArray
    pull: FloatArray
    residual: FloatArray
    moment_end: float = 0.0
    _compliance: FloatArray = field(init=False, repr=False)
    _lengthening: _Lengthening = field(init=False, repr=False)

    def __post_init__(self) -> None:
        # As the solver of the few equations wants it.
        object.__setattr__(self, "_compliance", np.asfortranarray(self.compliance))
        object.__setattr__(self, "_lengthening", _lengthening(self.share, self.advance))

    @property
    def is_corrected(self) -> bool:
        """Whether a solve found more than was foreseen."""
        return self.moment_end > 0.0

    def jumps_at(self, damage: FloatArray) -> FloatArray:
        """Return the jumps at another damage; (a, 3)."""
        free = self._free(damage)
        if not self.is_corrected:
            return _solved(self._system(damage), free.reshape(-1, 1)).reshape(-1, 3)
        both = np.array([free.ravel(), self.residual.ravel()]).T
        base, more = _solved(self._system(damage), both).T.reshape(2, -1, 3)
        return np.asarray(base + more * (self.moment(damage, base) / self.moment_end))

    def moment(self, damage: FloatArray, jump: FloatArray) -> float:
        """Return the force that the interfaces have let go since the block's start [uN].

        It is what the rest of the body feels of them.
        """
        forces = self.constants[:, :2] * jump[:, :2] * (damage - self.damage)[:, None]
        return float(np.abs(forces).sum())

    def rate_at(self, damage: FloatArray, jump: FloatArray) -> FloatArray:
        """Return dD/dN at a damage and the jumps there [1/cycle]; (a,)."""
        stress = self.springs * jump[:, :2]
        if self.nominal:
            stress *= (1.0 - damage)[:, None]
        return self.law.rate(stress[:, 0], stress[:, 1])

    def corrected(self, damage: FloatArray, jump: FloatArray) -> "Softening":
        """Return the same interfaces with what a solve at the end of a block found.

        Args:
            damage: D at the end; (a,).
            jump: Jumps of the solve; (a, 3).
        """
        free = (self._system(damage) @ jump.ravel()).reshape(-1, 3)
        residual = free - self._free(damage)
        moment = self.moment(damage, jump)
        size = np.linalg.norm(residual * np.sqrt(self.constants))
        least = SMALL_RESIDUAL * np.linalg.norm(self.jump * np.sqrt(self.constants))
        if size < least:
            return replace(self, moment_end=0.0)
        return replace(self, residual=residual, moment_end=moment)

    def _system(self, damage: FloatArray) -> FloatArray:
        let_go = (self.constants * (self.damage - damage)[:, None]).ravel()
        system: FloatArray = self._compliance * let_go
        system.T.reshape(-1)[:: len(let_go) + 1] += 1.0
        return system

    def _free(self, damage: FloatArray) -> FloatArray:
        x, y = _load_centre(damage, self._lengthening)
        shift = x - self.centre[0], y - self.centre[1]
        return np.asarray(self.jump + self.pull @ shift)


def load_centre(damage: FloatArray, share: FloatArray, advance: FloatArray) -> FloatArray:
    """Return how far the load is ahead of the tip for what softens [um]; (2,).

    Args:
        damage: D; (a,).
        share: g of each alone; (a,).
        advance: Where the tip would go if it broke [um]; (a, 2).
    """
    return np.array(_load_centre(damage, _lengthening(share, advance)))


def _lengthening(share: FloatArray, advance: FloatArray) -> _Lengthening:
    numbers = np.flatnonzero(advance[:, 0] > 0.0).tolist()
    return tuple((number, share.item(number), *advance[number].tolist()) for number in numbers)


def _load_centre(damage: FloatArray, lengthening: _Lengthening) -> tuple[float, float]:
    best, centre = 0.0, (0.0, 0.0)
    for number, share, x, y in lengthening:
        gone = released(damage.item(number), share)
        if gone > SOFTENING and gone * x > best:
            best, centre = gone * x, (gone * x, gone * y)
    return centre


def _solved(system: FloatArray, right: FloatArray) -> FloatArray:
    # numpy's and scipy's own wrappers take longer than the few equations.
    *_, solution, info = dgesv(system, right, overwrite_a=True, overwrite_b=True)
    if info:
        raise np.linalg.LinAlgError(f"softening interfaces: pivot {info} vanishes")
    return np.asarray(solution)


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """How a block goes.

    Attributes:
        cycles: Since the block's start, ascending from 0 [cycles]; (m,).
        damage: Of the softening interfaces; (m, a).
        released: Share of the force let go in the block that is gone by then, 0 to 1; (m,).
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
    state = _start_of(softening)
    nodes = [(state.cycles, state.damage, 0.0)]
    relieved = np.zeros(len(state.damage), dtype=bool)
    step, lead, first = _FIRST_STEP, -1, None
    for _ in range(_MOST_TRIES):
        room = softening.limit - state.damage
        if lead < 0:
            with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
                time = np.where((state.rate > 0.0) & ~relieved, room / state.rate, np.inf)
            lead = int(np.argmin(time))
            if not np.isfinite(time[lead]):
                break
        # Never the whole way at once, which would leave nothing to compare with.
        size = min(step, float(room[lead]) * (0.5 if len(nodes) == 1 else 1.0))
        after, error = _step(softening, state, lead, size)
        if after is None:
            step = 0.3 * size
            if step < _SHORTEST_STEP:
                relieved[lead] = True
                step, lead = _FIRST_STEP, -1
            continue
        over = after.damage - state.damage > room * (1.0 + 1e-9)
        over[lead] = False
        if over.any():
            part = np.full(len(room), np.inf)
            np.divide(room, after.damage - state.damage, out=part, where=over)
            lead = int(np.argmin(part))
            step = float(room[lead])
            continue
        if after.cycles > longest:
            if state.cycles > 0.5 * longest or size < _SHORTEST_STEP:
                break
            step = 0.9 * size * (longest - state.cycles) / (after.cycles - state.cycles)
            continue
        factor = 0.8 * (TOLERANCE / max(error, 1e-9)) ** (1.0 / 3.0)
        if error > TOLERANCE and size > _SHORTEST_STEP:
            step = size * max(factor, 0.2)
            continue
        at_limit = size == room[lead]
        if at_limit:
            after.damage[lead] = softening.limit[lead]
        state = after
        nodes.append((state.cycles, state.damage, softening.moment(state.damage, state.jump)))
        if at_limit:
            first = lead
            break
        step, lead = size * min(factor, 4.0), -1
    cycles, damage, moments = (np.array(values) for values in zip(*nodes, strict=True))
    whole = moments[-1]
    share = moments / whole if whole > 0.0 else np.linspace(0.0, 1.0, len(moments))
    return Course(cycles, damage, share, first)


@dataclass(frozen=True, slots=True, eq=False)
class _Moment:
    """Cycles since the block's start, and damage, jumps and rates then."""

    cycles: float
    damage: FloatArray
    jump: FloatArray
    rate: FloatArray


def _start_of(softening: Softening) -> _Moment:
    rate = softening.rate_at(softening.damage, softening.jump)
    return _Moment(0.0, softening.damage, softening.jump, rate)


def _step(
    softening: Softening, start: _Moment, lead: int, size: float
) -> tuple[_Moment | None, float]:
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
    return _Moment(cycles, damage, jump, rate), error
