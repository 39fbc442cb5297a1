"""Preconditioned solvers of one matrix: made, numbered, and run on it while its values move on."""

from collections import Counter
from collections.abc import Mapping

from pearlite_petsc.errors import SolverError
from pearlite_petsc.scene import Solver
from pearlite_petsc.solver.closing import Closing
from pearlite_petsc.solver.factors import Factors
from pearlite_petsc.solver.half_cycle import HalfCycle, allows_half_cycle
from pearlite_petsc.solver.krylov import (
    COMPLIANCE_PREFIX,
    FALLBACK_PREFIX,
    PREFIX,
    direct_settings,
    factor_settings,
    make_solver,
    may_coarsen_less,
    method_of,
    multigrid_settings,
    repeatable_factor_settings,
    stage,
)
from pearlite_petsc.solver.petsc import PETSc
from pearlite_petsc.solver.system import LinearSystem
from pearlite_petsc.solver.woodbury import corrected

RESIDUAL_LIMIT = 1e-6
"""Largest relative residual that a direct solver may leave."""


class Preconditioner(Closing):
    """A solver set up for one damage, which also solves at later ones. Collective; close it.

    Attributes:
        number: Among all factors and preconditioners of an equilibrium, from 1.
        damage: That it was made for; (k,).
        factors: What it consists of, if it is factors on one rank.
        half_cycle: Solves with the upward half of its multigrid cycle, where that may pay.

    Args:
        number: As above.
        system: The equations; of the damage that it was made for.
        ksp: The solver; closed with this.
        tolerance: Relative one of the solves to come.
        counters: Receives iterations, upward and symmetric_again, as ``Equilibrium`` says.
        is_factors: Whether the preconditioner consists of factors on one rank.
    """

    def __init__(
        self,
        number: int,
        system: LinearSystem,
        ksp: PETSc.KSP,
        tolerance: float,
        counters: Counter[str],
        is_factors: bool,
    ) -> None:
        self.number, self.damage = number, system.damage
        self._system, self._ksp, self._counters = system, ksp, counters
        self.factors: Factors | None = None
        if is_factors:
            pc = ksp.getPC()
            self.factors = Factors(number, self.damage, pc, system.ghosts, are_preconditioner=True)
        allowed = allows_half_cycle(ksp, PREFIX, tolerance)
        self.half_cycle = HalfCycle(ksp, PREFIX) if allowed else None

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        if self.half_cycle is not None:
            self.half_cycle.close()
        if self.factors is not None:
            self.factors.close()
        self._ksp.destroy()

    @property
    def relative_tolerance(self) -> float:
        """Of the residual, the user's word included."""
        return float(self._ksp.getTolerances()[0])

    @property
    def may_coarsen_less(self) -> bool:
        """Whether it is multigrid and the user leaves the size of aggregates to us."""
        return may_coarsen_less(self._ksp)

    def is_current(self) -> bool:
        """Return whether it was made for the damage that the system has now. Collective."""
        return self._system.has_damage(self.damage)

    def solve(self) -> tuple[int, int]:
        """Solve from the last solution; return iterations and PETSc's reason. Collective."""
        system, ksp = self._system, self._ksp
        woodbury = None if self.factors is None else self.factors.woodbury
        correction = None if woodbury is None else woodbury.correction(system.damage)
        with corrected(ksp, correction), stage("solve"):
            ksp.solve(system.b, system.x)
        self._counters["iterations"] += ksp.getIterationNumber()
        return int(ksp.getIterationNumber()), int(ksp.getConvergedReason())

    def solve_exactly(self) -> None:
        """Solve with the factors of the matrix as it is. Collective.

        Raises:
            SolverError: The residual is above ``RESIDUAL_LIMIT``.
        """
        _, reason = self.solve()
        relative = self._system.relative_residual()
        if reason < 0 or not relative < RESIDUAL_LIMIT:
            raise SolverError(
                f"direct solver: reason {reason}, relative residual {relative:.1e} against "
                f"{RESIDUAL_LIMIT:g}"
            )

    def solve_by_half_cycle(self) -> tuple[int, bool]:
        """Solve from the last solution; return iterations and whether it converged. Collective.

        Only where ``half_cycle`` is there.
        """
        assert self.half_cycle is not None
        with stage("solve"):
            iterations, converged = self.half_cycle.solve(self._system.b, self._system.x)
        self._counters["iterations"] += iterations
        self._counters["upward" if converged else "symmetric_again"] += 1
        return iterations, converged


class PreconditionerMaker:
    """Makes and numbers the preconditioners and factors of one system. Collective.

    Attributes:
        method: "iterative", "factors" or "direct".

    Args:
        system: The equations.
        settings: Method and tolerance.
        counters: Of ``Equilibrium``.
    """

    def __init__(self, system: LinearSystem, settings: Solver, counters: Counter[str]) -> None:
        self._system, self._counters = system, counters
        self._tolerance = settings.relative_tolerance
        self._unknowns = 3 * system.subdomain.element_count
        self.method = method_of(settings, system.comm.size, self._unknowns)
        self._made = 0

    def main(self, finer: bool) -> Preconditioner:
        """Return a preconditioner of the present damage, or factors for the direct method.

        A new solver each time: what GAMG would keep of the last one (its random vectors) must not
        decide what a restarted run computes.

        Args:
            finer: Whether multigrid is to coarsen less.
        """
        with stage("setup"):
            self._counters["setups"] += 1
            if self.method == "direct":
                return self._of(direct_settings(self._system.comm.size))
            if self.method == "factors":
                settings = factor_settings(self._system.comm.size, self._unknowns)
                try:
                    return self._of(settings, factors=True)
                except SolverError:
                    self._counters["multigrid"] += 1
            if finer:
                self._counters["finer"] += 1
            return self._of(multigrid_settings(finer))

    def fallback(self) -> Preconditioner:
        """Return a direct solver for the present damage."""
        with stage("setup"):
            self._counters["setups"] += 1
            return self._of(direct_settings(self._system.comm.size), FALLBACK_PREFIX)

    def factors(self) -> Factors:
        """Return factors of the matrix as it is, beside the preconditioner."""
        system = self._system
        settings = repeatable_factor_settings(system.comm.size, self._unknowns)
        with stage("setup"):
            ksp = make_solver(system.matrix, settings, 0.5, COMPLIANCE_PREFIX)
        pc = ksp.getPC()
        ksp.destroy()
        self._made += 1
        return Factors(self._made, system.damage, pc, system.ghosts, are_preconditioner=False)

    def _of(
        self, settings: Mapping[str, str], prefix: str = PREFIX, factors: bool = False
    ) -> Preconditioner:
        system = self._system
        ksp = make_solver(system.matrix, settings, self._tolerance, prefix)
        is_cholesky = ksp.getPC().getType() == PETSc.PC.Type.CHOLESKY
        self._made += 1
        alone = factors and is_cholesky and system.comm.size == 1
        return Preconditioner(self._made, system, ksp, self._tolerance, self._counters, alone)
