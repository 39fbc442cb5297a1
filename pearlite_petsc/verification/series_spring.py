"""One interface in series with a spring: its exact life, and that of the program's cycle jump."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import solve_ivp

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.cycle_jump import Block, Drive, RateCurve, exponent
from pearlite_petsc.fatigue.damage import DamageLaw, damage_law
from pearlite_petsc.fatigue.look_back import course_of, leading_share
from pearlite_petsc.mechanics.lefm import TIP_FACTOR
from pearlite_petsc.scene import Kind, State
from pearlite_petsc.verification.cases import DAMAGE, STATES

LENGTH = 4.0
STEEL_STATE = STATES["undeformed"]
THRESHOLD = TIP_FACTOR * STEEL_STATE.delta_k_th / np.sqrt(LENGTH)
"""Threshold stress of the interface [MPa]."""

FIRST_GUESS = {"euler": 0.0, "exponential": 3.0, "compliance": 0.6}
"""lambda or g of the first block, before anything is known."""

_MOST_BLOCKS = 100_000


@dataclass(frozen=True, slots=True)
class SeriesSpring:
    """An interface and a spring pulled together by a constant displacement range.

    With D the interface softens, takes more of the displacement, and its effective stress
    k_0 jump rises as 1/(1 - g D).

    Attributes:
        normal, shear: Effective stress ranges at D = 0 [MPa].
        share: g, the interface's share of the compliance, 0 <= g < 1; 0 is a constant stress.
        kind: Kind of the interface.
        nominal: Whether (1 - D) times the effective stress drives the damage.
        failure: D at which it breaks.
        state: Yield stress and threshold.
    """

    normal: float
    shear: float
    share: float
    kind: Kind = Kind.LAMELLA
    nominal: bool = False
    failure: float = 1.0
    state: State = STEEL_STATE

    def law(self) -> DamageLaw:
        """Return the damage law of the interface (k = 1)."""
        return damage_law(np.array([LENGTH]), np.array([self.kind]), DAMAGE, self.state, 0.0)

    def drive(self, damage: FloatArray) -> Drive:
        """Return what the program knows after a solve at a damage; (1,)."""
        rise = 1.0 / (1.0 - self.share * damage)
        return Drive(
            damage, self.normal * rise, self.shear * rise, self.law(), self.failure, self.nominal
        )

    def rate(self, damage: float) -> float:
        """Return dD/dN, Eq. (28)-(32), written out for one interface [1/cycle]."""
        strength = (
            DAMAGE.cementite_strength if self.kind == Kind.CEMENTITE else self.state.yield_stress
        )
        stress = (1.0 - damage if self.nominal else 1.0) / (1.0 - self.share * damage)
        factor = DAMAGE.c / (strength * DAMAGE.reference_length**1.5 * LENGTH)
        intensities = (stress * value * np.sqrt(LENGTH) for value in (self.normal, self.shear))
        over = [max(value - TIP_FACTOR * self.state.delta_k_th, 0.0) ** 3 for value in intensities]
        return float(factor * np.sqrt(over[0] ** 2 + DAMAGE.beta * over[1] ** 2))

    def exact_life(self) -> float:
        """Return the cycles to failure from dN/dD = 1/rate by an ODE solver at 1e-10."""
        solution = solve_ivp(
            lambda damage, _: [1.0 / self.rate(float(damage))],
            (0.0, self.failure),
            [0.0],
            method="DOP853",
            rtol=1e-11,
            atol=1e-14 / self.rate(0.0),
        )
        return float(solution.y[0, -1])

    def jumped_life(self, method: RateCurve, delta_d: float) -> float:
        """Return the cycles to failure by the program's blocks, infinite where it arrests.

        As the growth of a crack does, ``compliance`` looks back at each block from the solve after
        it.
        """
        damage = np.zeros(1)
        cycles, sensitivity = 0.0, FIRST_GUESS[method]
        last: Drive | None = None
        for _ in range(_MOST_BLOCKS):
            drive = self.drive(damage)
            if method == "exponential" and last is not None:
                sensitivity = self._exponent(last, drive, sensitivity)
            last = drive.with_sensitivity(np.array([sensitivity]))
            block = Block(last, delta_d, method)
            if not np.isfinite(block.longest):
                return float("inf")
            damage = block.damage_after(block.longest)
            spent = block.longest
            if method == "compliance":
                sensitivity, spent = self._looked_back(drive, float(damage[0]))
            cycles += spent
            if damage[0] >= 1.0:
                return cycles
        return float("inf")

    def _exponent(self, last: Drive, drive: Drive, known: float) -> float:
        rates = drive.rate_at(drive.damage), last.rate_at(last.damage)
        found = float(exponent(*rates, drive.damage, last.damage)[0])
        return known if np.isnan(found) else found

    def _looked_back(self, start: Drive, damage_end: float) -> tuple[float, float]:
        """Return g and a block's cycles from the stresses at its start and its end."""
        end = self.drive(np.array([damage_end]))
        before, after = (
            float(np.hypot(max(drive.normal[0], 0.0), drive.shear[0])) for drive in (start, end)
        )
        share = leading_share(before, after, float(start.damage[0]), damage_end)
        course = course_of(start.take(np.array([0])), share, min(damage_end, self.failure))
        return share, float(course.cycles[-1])

    def known_share(self) -> Drive:
        """Return the intact drive of a program that has learned g already."""
        drive = self.drive(np.zeros(1))
        return replace(drive, sensitivity=np.array([self.share]))

    def exact_damage(self, cycles: float) -> float:
        """Return D after some cycles by an ODE solver at 1e-10."""
        solution = solve_ivp(
            lambda _, damage: [self.rate(float(damage[0]))],
            (0.0, cycles),
            [0.0],
            method="DOP853",
            rtol=1e-11,
            atol=1e-13,
        )
        return float(solution.y[0, -1])
