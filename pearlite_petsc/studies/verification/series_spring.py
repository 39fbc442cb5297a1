"""One interface in series with a spring: its exact life, and that of the program's cycle jump."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import solve_ivp

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.course import course_of
from pearlite_petsc.fatigue.cycle_jumps.exponential import exponent
from pearlite_petsc.fatigue.damage import damage_interfaces
from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.fatigue.extrapolation import Extrapolation, RateModel
from pearlite_petsc.fatigue.release import next_release
from pearlite_petsc.fatigue.softening import FollowingLoad, Softening
from pearlite_petsc.laws.damage import RateConstants
from pearlite_petsc.mechanics.lefm import TIP_FACTOR
from pearlite_petsc.scene import Kind, State
from pearlite_petsc.studies.cases import DAMAGE, STATES

LENGTH = 4.0
STEEL_STATE = STATES["undeformed"]
THRESHOLD = TIP_FACTOR * STEEL_STATE.delta_k_th / np.sqrt(LENGTH)
"""Threshold stress of the interface [MPa]."""

FIRST_GUESS = 3.0
"""lambda of the first block, before anything is known."""

_MOST_BLOCKS = 100_000


@dataclass(frozen=True, slots=True)
class SeriesSpring:
    """An interface and a spring pulled together by a constant displacement range.

    With D the interface softens, takes more of the displacement, and its effective stress
    k_0 jump rises as 1/(1 - g D).

    Attributes:
        normal, shear: Effective stress ranges at D = 0 [MPa].
        stiffness_ratio: g of the interface, 0 <= g < 1; 0 is a constant stress.
        kind: Kind of the interface.
        nominal: Whether (1 - D) times the effective stress drives the damage.
        failure: D at which it breaks.
        state: Yield stress and threshold.
    """

    normal: float
    shear: float
    stiffness_ratio: float
    kind: Kind = Kind.LAMELLA
    nominal: bool = False
    failure: float = 1.0
    state: State = STEEL_STATE

    def rate_constants(self) -> RateConstants:
        """Return what the damage law makes of the interface (k = 1)."""
        length, kind = np.array([LENGTH]), np.array([self.kind])
        interfaces = damage_interfaces(length, kind, DAMAGE, self.state, 0.0)
        return DAMAGE.law.rate_constants(interfaces, DAMAGE)

    def drive(self, damage: FloatArray) -> Drive:
        """Return what the program knows after a solve at a damage; (1,)."""
        rise = 1.0 / (1.0 - self.stiffness_ratio * damage)
        return Drive(
            damage,
            self.normal * rise,
            self.shear * rise,
            self.rate_constants(),
            self.failure,
            self.nominal,
        )

    def rate(self, damage: float) -> float:
        """Return dD/dN, Eq. (28)-(32), written out for one interface [1/cycle]."""
        strength = (
            DAMAGE.cementite_strength if self.kind == Kind.CEMENTITE else self.state.yield_stress
        )
        stress = (1.0 - damage if self.nominal else 1.0) / (1.0 - self.stiffness_ratio * damage)
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

    def jumped_life(self, method: RateModel, delta_d: float) -> float:
        """Return the cycles to failure by the program's blocks, infinite where it arrests."""
        damage = np.zeros(1)
        cycles, sensitivity = 0.0, FIRST_GUESS
        last: Drive | None = None
        for _ in range(_MOST_BLOCKS):
            drive = self.drive(damage)
            if method == "compliance":
                course = course_of(self._softening(drive, delta_d))
                if course.first is None:
                    return float("inf")
                damage, spent = course.damage[-1], float(course.cycles[-1])
            else:
                if method == "exponential" and last is not None:
                    sensitivity = self._exponent(last, drive, sensitivity)
                last = drive.with_sensitivity(np.array([sensitivity]))
                block = Extrapolation(last, delta_d, method)
                spent = block.longest
                if not np.isfinite(spent):
                    return float("inf")
                damage = block.damage_after(spent)
            cycles += spent
            if damage[0] >= self.failure:
                return cycles
        return float("inf")

    def _softening(self, drive: Drive, delta_d: float) -> Softening:
        """Return the interface and what the spring makes of its compliance, k_0 = 1 MPa/um."""
        damage, ratio = drive.damage, np.array([self.stiffness_ratio])
        return Softening(
            damage=damage,
            limit=next_release(damage, ratio, self.failure, delta_d),
            jump=np.stack([drive.normal, drive.shear, np.zeros(1)], axis=1),
            constants=np.ones((1, 3)),
            springs=np.ones((1, 2)),
            compliance=np.eye(3) * ratio / (1.0 - ratio * damage),
            rates=drive.rates,
            nominal=self.nominal,
            load=FollowingLoad(damage, ratio, np.zeros((1, 2)), np.zeros((1, 3, 2))),
        )

    def _exponent(self, last: Drive, drive: Drive, known: float) -> float:
        rates = drive.rate_at(drive.damage), last.rate_at(last.damage)
        found = float(exponent(*rates, drive.damage, last.damage)[0])
        return known if np.isnan(found) else found

    def with_known_ratio(self) -> Drive:
        """Return the intact drive of a program that has learned g already."""
        drive = self.drive(np.zeros(1))
        return replace(drive, sensitivity=np.array([self.stiffness_ratio]))

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
