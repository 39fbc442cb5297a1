"""A small elastic body with a few springs in it, whose equilibrium is a dense solve."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.cycle_jumps.situation import (
    Block,
    CycleJumpMethod,
    Memory,
    Situation,
    Trial,
)
from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.fatigue.release import stiffness_ratio
from pearlite_petsc.fatigue.softening import FollowingLoad, Softening
from pearlite_petsc.laws import RateConstants
from pearlite_petsc.mechanics.springs import Stiffness

COUNT, UNKNOWNS = 5, 30
LENGTH = 1.2


@dataclass
class Body:
    """Springs 0 to 4 of one length in a random elastic body under a constant load range.

    Attributes:
        threshold: Of the damage law [MPa].
        most_coupled: Springs that may count as softening together.
        trials: What a cycle jump asked for.
    """

    threshold: float = 0.0
    most_coupled: int = COUNT
    seed: int = 2
    trials: list[Trial] = field(default_factory=list)

    def __post_init__(self) -> None:
        rng = np.random.default_rng(self.seed)
        self._rows = rng.normal(size=(3 * COUNT, UNKNOWNS))
        base = rng.normal(size=(UNKNOWNS, UNKNOWNS))
        self._rest = base @ base.T + 12.0 * np.eye(UNKNOWNS)
        self._load = 20.0 * rng.normal(size=UNKNOWNS)
        self.rates = RateConstants(
            np.geomspace(1e-9, 4e-9, COUNT), np.full(COUNT, self.threshold), 0.3
        )
        self.constants = np.full((COUNT, 3), 1.5)
        self.stiffness = Stiffness(np.full(COUNT, 60.0), np.full(COUNT, 60.0))
        self.ratio = stiffness_ratio(np.full(COUNT, 0.2))

    def jumps(self, damage: FloatArray) -> FloatArray:
        unknowns = np.linalg.solve(self._stiffness(damage), self._load)
        return (self._rows @ unknowns).reshape(COUNT, 3)

    def _stiffness(self, damage: FloatArray) -> FloatArray:
        springs = ((1.0 - damage)[:, None] * self.constants).ravel()
        return np.asarray(self._rest + self._rows.T @ (springs[:, None] * self._rows))

    # What couples the springs.

    def softening_interfaces(self, gain: FloatArray) -> IntArray:
        most = np.argsort(-gain)[: self.most_coupled]
        return np.sort(most[gain[most] > 0.01])

    def values_of(self, numbers: IntArray, values: FloatArray) -> FloatArray:
        return np.asarray(values[numbers])

    def with_values(self, numbers: IntArray, values: FloatArray, new: FloatArray) -> FloatArray:
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
        compliance = self._rows @ np.linalg.solve(self._stiffness(drive.damage), self._rows.T)
        rows = (3 * numbers[:, None] + np.arange(3)).ravel()
        count = len(numbers)
        rates = self.rates
        return Softening(
            damage=drive.damage[numbers],
            limit=limit[numbers],
            jump=jump[numbers],
            constants=self.constants[numbers],
            springs=np.stack([self.stiffness.k_n, self.stiffness.k_t], axis=1)[numbers],
            compliance=compliance[np.ix_(rows, rows)],
            rates=RateConstants(rates.factor[numbers], rates.threshold[numbers], rates.beta),
            nominal=False,
            load=FollowingLoad(
                drive.damage[numbers],
                stiffness_ratio[numbers],
                np.zeros((count, 2)),
                np.zeros((count, 3, 2)),
            ),
        )

    # What runs a cycle jump.

    def situation(self, damage: FloatArray, **changes: Any) -> Situation:
        values: dict[str, Any] = {
            "damage": damage,
            "jump": self.jumps(damage),
            "stiffness": self.stiffness,
            "rates": self.rates,
            "failure_damage": 1.0,
            "nominal": False,
            "stiffness_ratio": self.ratio,
            "coupling": self,
            "memory": Memory(),
        }
        return Situation(**values | changes)

    def block(self, method: CycleJumpMethod, start: Situation) -> Block | None:
        found = method(start)
        if found is None or isinstance(found, Block):
            return found
        try:
            trial = next(found)
            while True:
                self.trials.append(trial)
                trial = found.send(self.jumps(trial.damage))
        except StopIteration as end:
            block: Block | None = end.value
            return block

    def until_first_break(self, method: CycleJumpMethod) -> tuple[float, FloatArray, int]:
        """Return cycles, damage and blocks until the first spring breaks."""
        damage, memory, cycles = np.zeros(COUNT), Memory(), 0.0
        for number in range(1, 10_000):
            block = self.block(method, self.situation(damage, memory=memory))
            assert block is not None
            cycles += block.cycles
            damage, memory = block.damage, block.memory
            if (damage >= 1.0).any():
                return cycles, damage, number
        raise AssertionError("no spring breaks")

    def exact(self) -> tuple[float, FloatArray]:
        """Return cycles and damage until the first spring breaks, by an ODE solver at 1e-9."""

        def rate(_: float, damage: FloatArray) -> FloatArray:
            jump = self.jumps(damage)
            return self.rates.rate(self.stiffness.k_n * jump[:, 0], self.stiffness.k_t * jump[:, 1])

        def broken(_: float, damage: FloatArray) -> float:
            return float(damage.max() - 1.0)

        broken.terminal = True  # type: ignore[attr-defined]
        slowest = 2.0 / rate(0.0, np.zeros(COUNT)).max()
        found = solve_ivp(
            rate, (0.0, slowest), np.zeros(COUNT), "DOP853", events=broken, rtol=1e-9, atol=1e-11
        )
        assert found.status == 1
        return float(found.t[-1]), np.asarray(found.y[:, -1])
