"""One interface in series with a spring, as a cycle jump sees it."""

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Memory, Situation, Trials
from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.fatigue.softening import FollowingLoad, Softening
from pearlite_petsc.laws.damage import RateConstants
from pearlite_petsc.laws.law import called
from pearlite_petsc.mechanics.springs import Stiffness
from pearlite_petsc.scene import CycleJump

MOST_BLOCKS = 10_000


@dataclass(frozen=True, slots=True, eq=False)
class LoneInterface:
    """An interface (k_0 = 1 MPa/um) and a spring pulled together by a constant displacement range.

    With D the interface softens, takes more of the displacement, and its effective stress rises
    as 1/(1 - g D).

    Attributes:
        constants: What the damage law makes of it; k = 1.
        normal, shear: Effective stress ranges at D = 0 [MPa].
        stiffness_ratio: g, 0 <= g < 1; 0 is a constant stress.
    """

    constants: RateConstants
    normal: float
    shear: float
    stiffness_ratio: float

    def rate(self, damage: float) -> float:
        """Return dD/dN [1/cycle]."""
        rise = 1.0 / (1.0 - self.stiffness_ratio * damage)
        normal, shear = np.array([self.normal * rise]), np.array([self.shear * rise])
        return float(self.constants.rate(normal, shear)[0])

    def jump(self, damage: FloatArray) -> FloatArray:
        """Return the jumps in equilibrium at a damage [um, um, rad]; (1, 3)."""
        start = np.array([[self.normal, self.shear, 0.0]])
        return np.asarray(start / (1.0 - self.stiffness_ratio * damage[:, None]))

    def blocks(self, settings: CycleJump, most: int | None = None) -> list[Block]:
        """Return the blocks of a cycle jump until the interface breaks or has no rate.

        Args:
            settings: Method and largest increment of a block.
            most: Blocks after which to look no further; None takes ``MOST_BLOCKS``.
        """
        ratio = np.array([self.stiffness_ratio])
        damage, memory = np.zeros(1), Memory()
        found: list[Block] = []
        while damage[0] < 1.0 and len(found) < (MOST_BLOCKS if most is None else most):
            start = Situation(
                damage=damage,
                jump=self.jump(damage),
                stiffness=Stiffness(np.ones(1), np.ones(1)),
                rates=self.constants,
                failure_damage=1.0,
                nominal=False,
                stiffness_ratio=ratio,
                coupling=Alone(self.stiffness_ratio),
                memory=memory,
            )
            block = self._block(called(settings.method, start, settings))
            if block is None:
                break
            found.append(block)
            damage, memory = block.damage, block.memory
        return found

    def life(self, settings: CycleJump) -> float:
        """Return the cycles to failure by a cycle jump, infinite where it does not come to it."""
        blocks = self.blocks(settings)
        if not blocks or blocks[-1].damage[0] < 1.0:
            return float("inf")
        return sum(block.cycles for block in blocks)

    def _block(self, found: Block | Trials | None) -> Block | None:
        if not isinstance(found, Generator):
            return found
        try:
            trial = next(found)
            while True:
                trial = found.send(self.jump(trial.damage))
        except StopIteration as end:
            block: Block | None = end.value
            return block


@dataclass(frozen=True, slots=True)
class Alone:
    """The coupling of one interface with itself, through the spring.

    Attributes:
        stiffness_ratio: g.
    """

    stiffness_ratio: float

    def softening_interfaces(self, gain: FloatArray) -> IntArray:
        """Return the one interface."""
        return np.arange(len(gain))

    def values_of(self, numbers: IntArray, values: FloatArray) -> FloatArray:
        """Return values of some interfaces."""
        return values[numbers]

    def with_values(self, numbers: IntArray, values: FloatArray, new: FloatArray) -> FloatArray:
        """Return values with those of some interfaces replaced."""
        result = values.copy()
        result[numbers] = new
        return result

    def softening(
        self,
        numbers: IntArray,
        drive: Drive,
        jump: FloatArray,
        stiffness_ratio: FloatArray,
        limit: FloatArray,
    ) -> Softening:
        """Return the interface with its own compliance."""
        g = self.stiffness_ratio
        return Softening(
            damage=drive.damage,
            limit=limit,
            jump=jump,
            constants=np.ones((1, 3)),
            springs=np.ones((1, 2)),
            compliance=np.eye(3) * g / (1.0 - g * drive.damage),
            rates=drive.rates,
            nominal=drive.nominal,
            load=FollowingLoad(
                drive.damage, stiffness_ratio, np.zeros((1, 2)), np.zeros((1, 3, 2))
            ),
        )
