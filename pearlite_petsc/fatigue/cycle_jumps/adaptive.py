"""Cycle jump of interfaces that soften together, in blocks as long as a tolerance allows."""

from dataclasses import dataclass, replace

import numpy as np

from pearlite_petsc.fatigue.cycle_jumps.compliance import coupled_block
from pearlite_petsc.fatigue.cycle_jumps.situation import Memory, Situation, Trials

SHORTEST_BLOCK = 0.01
"""Least fraction of its force that an interface may release in a block."""

LEAST_CHANGE = 1e-3
"""Fraction of the tolerance below which a smaller change makes no longer block."""


@dataclass(frozen=True, slots=True)
class Adaptive:
    """Like ``Compliance``; a block whose solve changes the damage too much is made shorter.

    Attributes:
        delta_d: Largest fraction of its force that an interface may release in the first block.
        tolerance: Change of damage by the solve at a block's end that is accepted.
    """

    delta_d: float
    tolerance: float

    def __call__(self, start: Situation) -> Trials:
        """Try blocks until one is accepted, and return it."""
        delta_d = start.memory.numbers.get("delta_d", self.delta_d)
        rejected = undone = 0
        while True:
            found = yield from coupled_block(start, delta_d)
            if found is None:
                return None
            undone += found.block.counts.get("undone", 0)
            tried = delta_d
            accepted = True
            if found.change is not None:
                change = start.greatest(found.change)
                delta_d = self._next(delta_d, change)
                accepted = change <= self.tolerance or tried <= SHORTEST_BLOCK
            if accepted:
                counts = {"undone": undone, "rejected": rejected}
                return replace(
                    found.block, memory=Memory(numbers={"delta_d": delta_d}), counts=counts
                )
            rejected += 1

    def _next(self, delta_d: float, change: float) -> float:
        """Return the next block's length by what the solve of one changed."""
        change = max(change, LEAST_CHANGE * self.tolerance)
        delta_d *= float(np.clip(0.9 * np.sqrt(self.tolerance / change), 0.3, 2.0))
        return min(max(delta_d, SHORTEST_BLOCK), 1.0)
