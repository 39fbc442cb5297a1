"""When a preconditioner is renewed, and which cycle a solve takes: decided by iterations alone."""

from dataclasses import dataclass, replace
from math import inf, log10
from sys import float_info

SETUP_COST: tuple[tuple[float, float], ...] = ((3e3, 25.0), (1e4, 19.0), (1e5, 14.0), (1e6, 12.0))
"""(unknowns, cost of a new preconditioner in iterations), as ``bench solver`` measures it."""

MOST_HALF_CYCLES = 30
"""Iterations with half the multigrid cycle after which the whole cycle goes on."""

HALF_CYCLE_WORTH = 0.75
"""What an iteration with half the cycle reduces in iterations of the whole one; it costs 0.6."""


def setup_cost(unknowns: int) -> float:
    """Return what a new preconditioner costs in iterations, by the number of unknowns.

    >>> setup_cost(5_000)
    19.0
    """
    return next((cost for size, cost in SETUP_COST if unknowns <= size), SETUP_COST[-1][1])


def many_iterations(relative_tolerance: float) -> float:
    """Return beyond how many iterations smaller aggregates pay; good ones take 2.5 a digit.

    >>> many_iterations(1e-8)
    24.0
    """
    return 4.0 - 2.5 * log10(max(relative_tolerance, float_info.epsilon))


@dataclass(frozen=True, slots=True)
class ReusePolicy:
    """How long a preconditioner is reused while the damage moves on.

    It is kept until the iterations that it costs beyond its first solve add up to the price of a
    new one, which at worst doubles the best possible cost. Iterations are counted and not seconds,
    so that a run repeats itself bit for bit. Where a solve takes many iterations, the preconditioners
    that follow coarsen less.

    Attributes:
        setup_cost: Price of a new preconditioner [iterations].
        first_iterations: Of the first solve that measured the preconditioner.
        excess: Iterations beyond that, all solves since together.
        is_fresh: Whether no solve has measured it yet.
        half_cycle_pays: Whether the last try of half the cycle converged.
        is_finer: Whether multigrid coarsens less.
        next_is_finer: Whether it will from the next renewal on.

    >>> policy = ReusePolicy(setup_cost=10.0).after_whole_cycle(8)
    >>> policy.after_whole_cycle(19).is_worn
    True
    """

    setup_cost: float
    first_iterations: int = 0
    excess: float = 0.0
    is_fresh: bool = True
    half_cycle_pays: bool = True
    is_finer: bool = False
    next_is_finer: bool = False

    @property
    def is_worn(self) -> bool:
        """Whether the next solve needs a new preconditioner."""
        return self.excess > self.setup_cost

    @property
    def takes_half_cycle(self) -> bool:
        """Whether the next solve begins with half the cycle."""
        likely = self.first_iterations <= HALF_CYCLE_WORTH * MOST_HALF_CYCLES
        return self.half_cycle_pays and not self.is_fresh and likely

    def coarsens_too_much(self, iterations: int, relative_tolerance: float) -> bool:
        """Return whether a solve asks for a hierarchy that coarsens less than any so far.

        Args:
            iterations: Of the whole cycle.
            relative_tolerance: Of the solve.
        """
        return iterations > many_iterations(relative_tolerance) and not self.next_is_finer

    def renewed(self) -> "ReusePolicy":
        """Return the policy of a new preconditioner that coarsens as this one does."""
        return ReusePolicy(
            self.setup_cost, is_finer=self.is_finer, next_is_finer=self.next_is_finer
        )

    def worn_out(self) -> "ReusePolicy":
        """Return the policy by which what takes a worn preconditioner's place is made."""
        return replace(self, is_finer=self.next_is_finer)

    def after_half_cycle(self, iterations: int, converged: bool) -> "ReusePolicy":
        """Return the policy after a try of half the cycle.

        Args:
            iterations: It took.
            converged: Whether the solve ended with it.
        """
        beyond = max(0.0, HALF_CYCLE_WORTH * iterations - self.first_iterations)
        excess = self.excess + beyond if converged else self.excess
        return replace(self, half_cycle_pays=converged, excess=excess)

    def after_whole_cycle(
        self, iterations: int, in_vain: int = 0, measures: bool = True
    ) -> "ReusePolicy":
        """Return the policy after a solve with the whole cycle.

        Args:
            iterations: It took.
            in_vain: Those of half the cycle before.
            measures: Whether the solve tells how good a fresh preconditioner is.
        """
        first, fresh = self.first_iterations, self.is_fresh
        if fresh and measures:
            first, fresh = iterations, False
        beyond = 0 if fresh else max(0, in_vain + iterations - first)
        return replace(self, first_iterations=first, is_fresh=fresh, excess=self.excess + beyond)

    def after_direct_solve(self) -> "ReusePolicy":
        """Return the policy after a solve that only a direct solver could do."""
        return replace(self, excess=inf)

    def to_coarsen_less(self) -> "ReusePolicy":
        """Return the policy by which the next solve gets a hierarchy that coarsens less."""
        return replace(self, next_is_finer=True, excess=inf)
