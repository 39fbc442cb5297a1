"""Equilibrium of the elements: CG on the distributed matrix, with fallbacks counted."""

from collections import Counter

from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.scene import Solver
from pearlite_petsc.solver.closing import Closing
from pearlite_petsc.solver.equilibrium_state import EquilibriumState
from pearlite_petsc.solver.factors import Factors
from pearlite_petsc.solver.preconditioner import PreconditionerMaker
from pearlite_petsc.solver.reuse import ReusePolicy, setup_cost
from pearlite_petsc.solver.subdomain import Subdomain
from pearlite_petsc.solver.system import LinearSystem


class Equilibrium(Closing):
    """Solves K x = f while the damage grows. Collective; close it.

    ``ReusePolicy`` says when the preconditioner is renewed. On one rank, at loose tolerances, solves
    after the first one of a hierarchy take the upward half of its cycle; where that does not
    converge, the whole cycle goes on and stays until the next set-up.

    Attributes:
        system: The equations at the damage of now.
        policy: When the next preconditioner is made, and how.
        counters: iterations, solves, setups; finer (set-ups that coarsen less); upward (solves by
            half the cycle) and symmetric_again (where that did not converge); multigrid (instead of
            factors that failed), refreshed and direct (fallbacks); unit_loads (back-substitutions
            for the compliance of interfaces).

    Args:
        comm: The ranks.
        subdomain: What this rank knows of the mesh.
        damage: At the start, from now on read-only; shape (k,).
        settings: Method and tolerance.
        keep_first: Whether ``rewind`` will be wanted, which keeps the first preconditioner.
    """

    def __init__(
        self,
        comm: MPI.Comm,
        subdomain: Subdomain,
        damage: FloatArray,
        settings: Solver,
        keep_first: bool = False,
    ) -> None:
        self.counters: Counter[str] = Counter()
        self.system = LinearSystem(comm, subdomain, damage)
        self.policy = ReusePolicy(setup_cost(3 * subdomain.element_count))
        self._maker = PreconditionerMaker(self.system, settings, self.counters)
        self._preconditioner = self._maker.main(finer=False)
        self._first = self._preconditioner if keep_first else None
        self._factors: Factors | None = None

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        if self._factors is not None:
            self._factors.close()
        if self._first is not None and self._first.number != self._preconditioner.number:
            self._first.close()
        self._preconditioner.close()
        self.system.close()

    def update(self, damage: FloatArray) -> None:
        """Take the damage of the subdomain's interfaces, from now on read-only; shape (k,)."""
        self.system.update(damage)

    def solve(self, load: FloatArray, guess: FloatArray | None = None) -> FloatArray:
        """Return the unknowns in equilibrium with the load.

        Args:
            load: (F_x, F_y, M) on owned elements [uN, uN, uN um]; shape (owned, 3).
            guess: Unknowns to start from; None starts from the last solution.

        Returns:
            Unknowns (X, Y, phi) of owned elements and ghosts [um]; shape (owned + g, 3).

        Raises:
            SolverError: Neither CG nor a direct solver found the equilibrium.
        """
        self.system.set_load(load)
        if guess is not None:
            self.system.start_from(guess)
        self.counters["solves"] += 1
        if self._maker.method == "direct":
            if not self._preconditioner.is_current():
                self.renew()
            self._preconditioner.solve_exactly()
        else:
            self._solve_iterative()
        return self.system.unknowns()

    def jumps(self, unknowns: FloatArray) -> FloatArray:
        """Return (normal, tangential, rotational) jump of each interface of the subdomain; (k, 3)."""
        return self.system.jumps(unknowns)

    def renew(self) -> None:
        """Make the preconditioner anew, for the damage of now. Collective."""
        self._release()
        self._preconditioner = self._maker.main(self.policy.is_finer)
        self.policy = self.policy.renewed()

    def rewind(self) -> None:
        """Go back to the damage and preconditioner of the start and to a zero guess. Collective.

        Only where ``keep_first`` was given. The preconditioner counts as set up, so that the
        counters do not tell which crack of a mesh was the first.
        """
        assert self._first is not None
        self.update(self._first.damage)
        self.system.x.set(0.0)
        self.counters.clear()
        self.counters["setups"] = 1
        self._release()
        self._preconditioner = self._first
        self.policy = ReusePolicy(self.policy.setup_cost)

    def state(self) -> EquilibriumState:
        """Return what ``restore`` needs to go on bit for bit."""
        return EquilibriumState(self._preconditioner.damage, self.system.solution(), self.policy)

    def restore(self, state: EquilibriumState) -> None:
        """Go on from a state: the preconditioner of then, and the solution to start from."""
        damage = self.system.damage
        self.update(state.set_up_damage)
        self._release()
        self._preconditioner = self._maker.main(state.policy.is_finer)
        self.update(damage)
        self.system.start_from(state.solution)
        self.policy = state.policy

    def factors(self, damage: FloatArray) -> Factors:
        """Return factors of the matrix at a damage, as long as ``holds`` says so. Collective.

        The preconditioner's where it consists of factors on one rank, made anew if need be; else
        others, which are kept until those of another damage are asked for.

        Args:
            damage: Of the subdomain's interfaces, from now on read-only; (k,).
        """
        now = self.system.damage
        self.update(damage)
        if self._preconditioner.factors is not None and not self._preconditioner.is_current():
            self.renew()
        found = self._preconditioner.factors or self._other_factors()
        self.update(now)
        return found

    def holds(self, factors: Factors) -> bool:
        """Return whether these are still the factors to solve with, by their number."""
        held = self._preconditioner.factors, self._factors
        return factors.number in {each.number for each in held if each is not None}

    def _other_factors(self) -> Factors:
        """Return factors of the damage of now beside the preconditioner. Collective."""
        if self._factors is not None and not self.system.has_damage(self._factors.damage):
            self._factors.close()
            self._factors = None
        self._factors = self._factors or self._maker.factors()
        return self._factors

    def _release(self) -> None:
        """Let go of the preconditioner before another one takes its place and memory."""
        if self._first is None or self._preconditioner.number != self._first.number:
            self._preconditioner.close()
        elif self._first.factors is not None:
            # What has softened since is not what softens in the next crack.
            self._first.factors.woodbury = None

    def _solve_iterative(self) -> None:
        if self.policy.is_worn:
            self.policy = self.policy.worn_out()
            self.renew()
        start = self.system.solution()
        in_vain, converged = self._try_half_cycle()
        if converged:
            return
        iterations, reason = self._preconditioner.solve()
        if reason < 0 and not self._preconditioner.is_current():
            self.counters["refreshed"] += 1
            self.renew()
            self.system.start_from(start)
            iterations, reason = self._preconditioner.solve()
        if reason < 0:
            self.counters["direct"] += 1
            self.policy = self.policy.after_direct_solve()
            with self._maker.fallback() as fallback:
                fallback.solve_exactly()
            return
        # Factors solve at once what they were made for, which is no measure of what follows.
        measures = (
            self._preconditioner.factors is None
            or not self.policy.is_fresh
            or not self._preconditioner.is_current()
        )
        self.policy = self.policy.after_whole_cycle(iterations, in_vain, measures)
        tolerance = self._preconditioner.relative_tolerance
        if (
            self.policy.coarsens_too_much(iterations, tolerance)
            and self._preconditioner.may_coarsen_less
        ):
            self.policy = self.policy.to_coarsen_less()

    def _try_half_cycle(self) -> tuple[int, bool]:
        """Return the iterations with half the cycle, 0 without, and whether they did it."""
        if not self.policy.takes_half_cycle or self._preconditioner.half_cycle is None:
            return 0, False
        iterations, converged = self._preconditioner.solve_by_half_cycle()
        self.policy = self.policy.after_half_cycle(iterations, converged)
        return iterations, converged
