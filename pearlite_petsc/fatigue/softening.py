"""Interfaces that soften together: their jumps at any damage.

The body outside a few interfaces is linear. With the compliance C of their jumps to pairs of
forces, each with its springs as they were at the damage D_0, the jumps at a damage D are

    (I - C diag(k (D - D_0))) jump = jump_0 + pull shift + residual,

exact as long as nothing else softens: ``shift`` is how far the load has followed the tip, ``pull``
what that does to the jumps. ``residual`` is what a solve at the end of a block finds beside it.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.linalg.lapack import dgesv

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.release import released
from pearlite_petsc.laws.damage import RateConstants

SOFTENING = 0.02
"""Fraction of its force from which an interface that lets go moves the load."""

SMALL_RESIDUAL = 3e-3
"""Fraction of the jumps below which what a solve finds changes nothing."""

_Lengthening = tuple[tuple[int, float, float, float], ...]
# Number, g and advance [um] of the few interfaces that would lengthen the crack.


@dataclass(frozen=True, slots=True, eq=False)
class FollowingLoad:
    """How the load follows the tip to where the interfaces that soften will take it.

    Attributes:
        damage: D_0; (a,).
        stiffness_ratio: g of each alone, by which its release of force moves the load; (a,).
        advance: Where the tip would go if it broke, from where it is [um]; (a, 2).
        pull: Jumps per um that the load moves in x and in y [um, um, rad]; (a, 3, 2).
    """

    damage: FloatArray
    stiffness_ratio: FloatArray
    advance: FloatArray
    pull: FloatArray
    _lengthening: _Lengthening = field(init=False, repr=False)
    _start: tuple[float, float] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        numbers = np.flatnonzero(self.advance[:, 0] > 0.0).tolist()
        lengthening = tuple(
            (number, self.stiffness_ratio.item(number), *self.advance[number].tolist())
            for number in numbers
        )
        object.__setattr__(self, "_lengthening", lengthening)
        object.__setattr__(self, "_start", self.centre(self.damage))

    def centre(self, damage: FloatArray) -> tuple[float, float]:
        """Return how far the load is ahead of the tip at a damage (a,) [um]."""
        best, centre = 0.0, (0.0, 0.0)
        for number, stiffness_ratio, x, y in self._lengthening:
            gone = released(damage.item(number), stiffness_ratio)
            if gone > SOFTENING and gone * x > best:
                best, centre = gone * x, (gone * x, gone * y)
        return centre

    def jumps(self, damage: FloatArray) -> FloatArray:
        """Return what the load's way from D_0 to a damage (a,) adds to the jumps; (a, 3)."""
        x, y = self.centre(damage)
        return np.asarray(self.pull @ (x - self._start[0], y - self._start[1]))


@dataclass(frozen=True, slots=True, eq=False)
class Correction:
    """What a solve at the end of a block found beside what was foreseen.

    Attributes:
        residual: What the free jumps gain by the block's end [um, um, rad]; (a, 3).
        force: ``force_let_go`` at that end, > 0 [uN].
    """

    residual: FloatArray
    force: float


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
        rates: Rate constants.
        nominal: Whether (1 - D) times the effective stress drives the damage.
        load: How the load follows.
        correction: What a solve found, None before the first and where it found nothing.
    """

    damage: FloatArray
    limit: FloatArray
    jump: FloatArray
    constants: FloatArray
    springs: FloatArray
    compliance: FloatArray
    rates: RateConstants
    nominal: bool
    load: FollowingLoad
    correction: Correction | None = None
    _compliance: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        # As the solver of the few equations wants it.
        object.__setattr__(self, "_compliance", np.asfortranarray(self.compliance))

    def jumps_at(self, damage: FloatArray) -> FloatArray:
        """Return the jumps at another damage; (a, 3)."""
        free = self._free(damage)
        if self.correction is None:
            return _solved(self._system(damage), free.reshape(-1, 1)).reshape(-1, 3)
        both = np.array([free.ravel(), self.correction.residual.ravel()]).T
        base, more = _solved(self._system(damage), both).T.reshape(2, -1, 3)
        fraction = self.force_let_go(damage, base) / self.correction.force
        return np.asarray(base + more * fraction)

    def force_let_go(self, damage: FloatArray, jump: FloatArray) -> float:
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
        return self.rates.rate(stress[:, 0], stress[:, 1])

    def corrected(self, damage: FloatArray, jump: FloatArray) -> "Softening":
        """Return the same interfaces with what a solve at the end of a block found.

        Args:
            damage: D at the end; (a,).
            jump: Jumps of the solve; (a, 3).
        """
        free = (self._system(damage) @ jump.ravel()).reshape(-1, 3)
        residual = free - self._free(damage)
        force = self.force_let_go(damage, jump)
        size = np.linalg.norm(residual * np.sqrt(self.constants))
        least = SMALL_RESIDUAL * np.linalg.norm(self.jump * np.sqrt(self.constants))
        if size < least or force == 0.0:
            return replace(self, correction=None)
        return replace(self, correction=Correction(residual, force))

    def _system(self, damage: FloatArray) -> FloatArray:
        let_go = (self.constants * (self.damage - damage)[:, None]).ravel()
        system: FloatArray = self._compliance * let_go
        system.T.reshape(-1)[:: len(let_go) + 1] += 1.0
        return system

    def _free(self, damage: FloatArray) -> FloatArray:
        return np.asarray(self.jump + self.load.jumps(damage))


def _solved(system: FloatArray, right: FloatArray) -> FloatArray:
    # numpy's and scipy's own wrappers take longer than the few equations.
    *_, solution, info = dgesv(system, right, overwrite_a=True, overwrite_b=True)
    if info:
        raise np.linalg.LinAlgError(f"softening interfaces: pivot {info} vanishes")
    return np.asarray(solution)
