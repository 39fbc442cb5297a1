"""Equilibrium of the elements: CG on the distributed matrix, with fallbacks counted."""

from collections import Counter
from collections.abc import Callable

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import SolverError
from pearlite_petsc.mechanics.kinematics import jumps
from pearlite_petsc.scene import Solver
from pearlite_petsc.solver.corrected import Correction, corrected
from pearlite_petsc.solver.ghosts import GhostExchange
from pearlite_petsc.solver.krylov import (
    COMPLIANCE_PREFIX,
    FALLBACK_PREFIX,
    PREFIX,
    direct_settings,
    factor_settings,
    make_solver,
    many_iterations,
    may_coarsen_less,
    method_of,
    multigrid_settings,
    repeatable_factor_settings,
    setup_cost,
    stage,
)
from pearlite_petsc.solver.matrix import StiffnessMatrix
from pearlite_petsc.solver.part import Part
from pearlite_petsc.solver.petsc import PETSc
from pearlite_petsc.solver.upward import MOST_UPWARD, WORTH, UpwardCycle, allows_upward

Correct = Callable[[FloatArray], Correction | None]

RESIDUAL_LIMIT = 1e-6
"""Largest relative residual that a direct solver may leave."""


class Equilibrium:
    """Solves K x = f while the damage grows. Collective; use as a context manager.

    The preconditioner is kept until the iterations that it costs beyond its first solve add up to
    the price of a new one, which at worst doubles the best possible cost. The decision counts
    iterations and not seconds, so that a run repeats itself bit for bit. On one rank, at loose
    tolerances, solves after the first one of a hierarchy take the upward half of its cycle; where
    that does not converge, the whole cycle goes on and stays until the next set-up. Where a solve
    takes many iterations, the next one gets a hierarchy that coarsens less, and so on until the
    mesh changes or another crack begins.

    Attributes:
        matrix: K of the current damage.
        counters: iterations, solves, setups; finer (set-ups that coarsen less); upward (solves by
            half the cycle) and symmetric_again (where that did not converge); multigrid (instead of
            factors that failed), refreshed and direct (fallbacks); unit_loads (back-substitutions
            for the compliance of interfaces).
        set_up_damage: Damage that the preconditioner was made for; (k,).

    Args:
        comm: The ranks.
        part: This rank's share of the mesh.
        damage: At the start; shape (k,), not changed afterwards.
        settings: Method and tolerance.
        keep_first: Whether ``restart`` will be wanted, which keeps the first preconditioner.
    """

    def __init__(
        self,
        comm: MPI.Comm,
        part: Part,
        damage: FloatArray,
        settings: Solver,
        keep_first: bool = False,
    ) -> None:
        self.part, self.settings = part, settings
        self._method = method_of(settings, comm.size, 3 * part.total)
        self.counters: Counter[str] = Counter()
        self.operator = part.jump_operator()
        with stage("assemble"):
            self.matrix = StiffnessMatrix(comm, part, self.operator, damage)
        self._damage = damage
        self._comm = comm
        self._x, self._b = self.matrix.mat.createVecs()
        self._ghosts = GhostExchange(self._x, part)
        self._ksp: PETSc.KSP | None = None
        self._first_ksp: PETSc.KSP | None = None
        self._correct: Correct | None = None
        self._upward: UpwardCycle | None = None
        self._first_damage = damage
        self._setup_cost = setup_cost(3 * part.total)
        self._first_iterations = 0
        self._finer = self._finer_next = False
        self._set_up()
        if keep_first:
            self._first_ksp = self._ksp

    def __enter__(self) -> "Equilibrium":
        return self

    def __exit__(self, *exc: object) -> None:
        self._correct = None
        if self._upward is not None:
            self._upward.destroy()
        for ksp in (self._ksp, self._first_ksp):
            if ksp is not None:
                ksp.destroy()
        self._ghosts.close()
        self._x.destroy()
        self._b.destroy()
        self.matrix.__exit__()

    @property
    def mat(self) -> PETSc.Mat:
        """The matrix."""
        return self.matrix.mat

    def update(self, damage: FloatArray) -> None:
        """Take the damage of the part's interfaces; shape (k,), not changed afterwards."""
        if damage is self._damage:
            return
        self._damage = damage
        with stage("assemble"):
            self.matrix.update(damage)

    def solve(self, load: FloatArray, guess: FloatArray | None = None) -> FloatArray:
        """Return the unknowns in equilibrium with the load.

        Args:
            load: (F_x, F_y, M) on own elements [uN, uN, uN um]; shape (own, 3).
            guess: Unknowns to start from; None starts from the last solution.

        Returns:
            Unknowns (X, Y, phi) of own elements and ghosts [um]; shape (own + g, 3).

        Raises:
            SolverError: Neither CG nor a direct solver found the equilibrium.
        """
        self._b.setArray(self.part.right_hand_side(load))
        if guess is not None:
            self._x.setArray(guess[: self.part.own].ravel())
        self.counters["solves"] += 1
        if self._method == "direct":
            if self.set_up_damage is not self._damage:
                self._set_up()
            self._solve_direct(self._ksp)
        else:
            self._solve_iterative()
        return self.unknowns()

    def restart(self) -> None:
        """Go back to the damage and preconditioner of the start and to a zero guess. Collective.

        Only where ``keep_first`` was given. The preconditioner counts as set up, so that the
        counters do not tell which crack of a mesh was the first.
        """
        assert self._first_ksp is not None
        self.update(self._first_damage)
        self._x.set(0.0)
        self.counters.clear()
        self.counters["setups"] = 1
        self._finer = self._finer_next = False
        self._take_up(self._first_ksp)

    def memory(self) -> dict[str, FloatArray]:
        """Return what the next solve depends on beside the damage, for a checkpoint.

        The damage of the last set-up (k,), the last solution of own elements (own, 3), and
        (first iterations, excess, fresh, whether half the cycle pays, whether multigrid coarsens
        less, whether it will from the next set-up on).
        """
        flags = self._fresh, self._upward_pays, self._finer, self._finer_next
        reuse = (self._first_iterations, self._excess, *flags)
        state = np.array(reuse, dtype=float)
        solution = self._x.getArray(readonly=True).reshape(-1, 3).copy()
        return {"set_up_damage": self.set_up_damage, "solution": solution, "reuse": state}

    def recall(self, memory: dict[str, FloatArray]) -> None:
        """Go on from a checkpoint: the preconditioner of then, and the solution to start from."""
        first, excess, *flags = memory["reuse"].tolist()
        fresh, pays, finer, finer_next = map(bool, flags)
        damage = self._damage
        self.update(memory["set_up_damage"])
        self._finer, self._finer_next = finer, finer_next
        self._set_up()
        self.update(damage)
        self._x.setArray(memory["solution"].ravel())
        self._first_iterations, self._excess = int(first), excess
        self._fresh, self._upward_pays = fresh, pays

    def factors(self) -> PETSc.PC:
        """Return factors of the matrix as it is, the caller's to destroy. Collective.

        Where the preconditioner consists of factors on one rank, these, made anew if need be.
        """
        if self._own_factors() is not None and not self._is_current():
            self._set_up()
        own = self._own_factors()
        if own is not None:
            return own
        settings = repeatable_factor_settings(self._comm.size, 3 * self.part.total)
        with stage("setup"):
            ksp = make_solver(self.matrix, settings, 0.5, COMPLIANCE_PREFIX)
        pc = ksp.getPC()
        ksp.destroy()
        return pc

    def correct(self, factors: PETSc.PC, correct: Correct) -> None:
        """Correct the preconditioner for what softens, if it still consists of these factors.

        Args:
            factors: What ``factors`` returned.
            correct: Damage of the part's interfaces (k,) -> correction.
        """
        if self.shares(factors):
            self._correct = correct

    def shares(self, factors: PETSc.PC) -> bool:
        """Return whether the preconditioner consists of these factors."""
        return bool(self._own_factors() == factors)

    def values(self, vector: PETSc.Vec) -> FloatArray:
        """Return a vector's values on own elements and ghosts; shape (own + g, 3). Collective."""
        return self._ghosts.values(vector)

    def unknowns(self) -> FloatArray:
        """Return the last solution on own elements and ghosts [um]; (own + g, 3). Collective."""
        return self.values(self._x)

    def jumps(self, unknowns: FloatArray) -> FloatArray:
        """Return (normal, tangential, rotational) jump of each interface of the part; (k, 3)."""
        i, j = self.part.pairs.T
        return jumps(self.operator, unknowns[i], unknowns[j])

    def _make_ksp(self, direct: bool, prefix: str = PREFIX) -> PETSc.KSP:
        self.counters["setups"] += 1
        tolerance = self.settings.relative_tolerance
        with stage("setup"):
            if direct:
                return make_solver(self.matrix, direct_settings(self._comm.size), tolerance, prefix)
            if self._method == "factors":
                settings = factor_settings(self._comm.size, 3 * self.part.total)
                try:
                    return make_solver(self.matrix, settings, tolerance, prefix)
                except SolverError:
                    self.counters["multigrid"] += 1
            if self._finer:
                self.counters["finer"] += 1
            return make_solver(self.matrix, multigrid_settings(self._finer), tolerance, prefix)

    def _set_up(self) -> None:
        """Make the preconditioner (or factors) of the current values.

        A new solver each time: what GAMG would keep of the last one (its random vectors) must not
        decide what a restarted run computes.
        """
        self._take_up(self._make_ksp(self._method == "direct"))

    def _own_factors(self) -> PETSc.PC | None:
        """Return the preconditioner if it consists of factors on one rank."""
        if self._comm.size > 1 or self._method != "factors" or self._ksp is None:
            return None
        pc = self._ksp.getPC()
        return pc if pc.getType() == PETSc.PC.Type.CHOLESKY else None

    def _take_up(self, ksp: PETSc.KSP) -> None:
        """Solve with this preconditioner, which was made for the current damage, from now on."""
        if self._ksp is not None and self._ksp not in (ksp, self._first_ksp):
            self._ksp.destroy()
        if self._upward is not None:
            self._upward.destroy()
        self._ksp = ksp
        self._correct = None
        allowed = allows_upward(ksp, PREFIX, self.settings.relative_tolerance)
        self._upward = UpwardCycle(ksp, PREFIX) if allowed else None
        self.set_up_damage = self._damage
        self._fresh = self._upward_pays = True
        self._excess = 0.0

    def _solve_iterative(self) -> None:
        if self._excess > self._setup_cost:
            self._finer = self._finer_next
            self._set_up()
        start = self._x.getArray().copy()
        before = 0
        if self._upward_pays and not self._fresh and self._first_iterations <= WORTH * MOST_UPWARD:
            before, converged = self._run_upward()
            if converged:
                self._excess += max(0.0, WORTH * before - self._first_iterations)
                return
        correction = None if self._correct is None else self._correct(self._damage)
        with corrected(self._ksp, correction):
            iterations, reason = self._run(self._ksp)
        if reason < 0 and not self._is_current():
            self.counters["refreshed"] += 1
            self._set_up()
            self._x.setArray(start)
            iterations, reason = self._run(self._ksp)
        if reason < 0:
            self.counters["direct"] += 1
            self._excess = np.inf
            ksp = self._make_ksp(True, FALLBACK_PREFIX)
            try:
                self._solve_direct(ksp)
            finally:
                ksp.destroy()
            return
        self._judge(before, iterations)

    def _judge(self, before: int, iterations: int) -> None:
        """Decide when and how the next preconditioner is made, by the iterations of a solve.

        Args:
            before: Of half the cycle in vain.
            iterations: After them.
        """
        # Factors solve at once what they were made for, which is no measure of what follows.
        if self._fresh and (self._own_factors() is None or not self._is_current()):
            self._first_iterations, self._fresh = iterations, False
        if not self._fresh:
            self._excess += max(0, before + iterations - self._first_iterations)
        ksp = self._ksp
        assert ksp is not None
        many = iterations > many_iterations(ksp.getTolerances()[0])
        if many and not self._finer_next and may_coarsen_less(ksp):
            self._finer_next, self._excess = True, np.inf

    def _run_upward(self) -> tuple[int, bool]:
        if self._upward is None:
            return 0, False
        with stage("solve"):
            iterations, converged = self._upward.solve(self._b, self._x)
        self.counters["iterations"] += iterations
        self.counters["upward" if converged else "symmetric_again"] += 1
        self._upward_pays = converged
        return iterations, converged

    def _is_current(self) -> bool:
        """Whether the preconditioner was made for the current damage. Collective."""
        same = np.array_equal(self.set_up_damage, self._damage)
        return bool(self._comm.allreduce(same, MPI.LAND))

    def _solve_direct(self, ksp: PETSc.KSP) -> None:
        _, reason = self._run(ksp)
        residual = self._b.duplicate()
        self.mat.mult(self._x, residual)
        residual.axpy(-1.0, self._b)
        relative = residual.norm() / max(self._b.norm(), np.finfo(float).tiny)
        residual.destroy()
        if reason < 0 or not relative < RESIDUAL_LIMIT:
            raise SolverError(
                f"direct solver: reason {reason}, relative residual {relative:.1e} against "
                f"{RESIDUAL_LIMIT:g}"
            )

    def _run(self, ksp: PETSc.KSP) -> tuple[int, int]:
        with stage("solve"):
            ksp.solve(self._b, self._x)
        iterations = ksp.getIterationNumber()
        self.counters["iterations"] += iterations
        return iterations, int(ksp.getConvergedReason())
