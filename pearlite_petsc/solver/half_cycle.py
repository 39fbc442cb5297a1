"""The upward half of a multigrid cycle: cheaper where the whole cycle does well."""

from collections.abc import Callable
from math import log

from pearlite_petsc.solver.closing import Closing
from pearlite_petsc.solver.options import prefixed_options
from pearlite_petsc.solver.petsc import PETSc
from pearlite_petsc.solver.reuse import MOST_HALF_CYCLES

SUFFIX = "upward_"
"""Of the options' prefix, after that of the other solver."""

FLEXIBLE_CG = {
    # The half cycle is not symmetric.
    "ksp_type": "fcg",
    "ksp_fcg_mmax": "1",
    "ksp_norm_type": "unpreconditioned",
}

LEAST_TOLERANCE = 1e-7
"""Relative tolerance below which the whole cycle is as fast: its iterations keep their rate."""

PATIENCE = 12
"""Iterations from which the whole cycle goes on at once where the rate so far needs more than that.

Both together then stay below 40 iterations where the whole cycle alone takes up to 23.
"""

_THEIRS = ("ksp_type", "ksp_norm", "ksp_conv", "ksp_error", "pc_mg_type")


class HalfCycle(Closing):
    """Flexible CG with the upward half of another solver's multigrid cycle.

    The residual is restricted without smoothing, and smoothed on the way up alone. The hierarchy
    is shared, and the whole cycle is back in place after each solve.

    Args:
        ksp: Of which ``allows_half_cycle`` holds.
        prefix: Of its options.
    """

    def __init__(self, ksp: PETSc.KSP, prefix: str) -> None:
        self._whole = ksp
        self._ksp = PETSc.KSP().create(ksp.comm)
        self._ksp.setOptionsPrefix(prefix + SUFFIX)
        self._ksp.setPC(ksp.getPC())
        with prefixed_options(prefix + SUFFIX, FLEXIBLE_CG):
            self._ksp.setFromOptions()
        self._ksp.setInitialGuessNonzero(True)

    def close(self) -> None:
        """Destroy what is not the other solver's. Collective."""
        self._ksp.destroy()

    def solve(self, load: PETSc.Vec, x: PETSc.Vec) -> tuple[int, bool]:
        """Solve to the other solver's tolerance from the values of x. Collective.

        Args:
            load: Right-hand side; 3 unknowns an owned element.
            x: Start and solution; likewise. A solve that fails leaves what it has reached, or the
                start if that is no better than zero.

        Returns:
            Iterations, and whether it converged.
        """
        relative, absolute, divergence, most = self._whole.getTolerances()
        self._ksp.setTolerances(relative, absolute, divergence, min(most, MOST_HALF_CYCLES))
        self._ksp.setConvergenceTest(_until(max(relative * load.norm(), absolute)))
        start = x.copy()
        pc = self._ksp.getPC()
        pc.setMGType(PETSc.PC.MGType.KASKADE)
        try:
            self._ksp.solve(load, x)
        finally:
            pc.setMGType(PETSc.PC.MGType.MULTIPLICATIVE)
        converged = self._ksp.getConvergedReason() > 0
        if not converged and not self._ksp.getResidualNorm() < load.norm():
            start.copy(x)
        start.destroy()
        return self._ksp.getIterationNumber(), converged


def _until(target: float) -> Callable[[PETSc.KSP, int, float], int | None]:
    """Return the test that ends a solve: at the target, or where it is too far."""
    reasons = PETSc.KSP.ConvergedReason
    first = 0.0

    def test(_: PETSc.KSP, iteration: int, norm: float) -> int | None:
        nonlocal first
        if norm <= target:
            return int(reasons.CONVERGED_RTOL)
        if iteration == 0:
            first = norm
        elif iteration >= PATIENCE:
            progress = log(first / norm) / log(first / target) if target > 0.0 else 0.0
            if progress < iteration / MOST_HALF_CYCLES:
                return int(reasons.DIVERGED_MAX_IT)
        return None

    return test


def allows_half_cycle(ksp: PETSc.KSP, prefix: str, tolerance: float) -> bool:
    """Return whether half of a solver's cycle pays and its user leaves the choice to us.

    On several ranks, which smooth each its subdomain alone, it does not: half the cycle takes half as
    many iterations again as on one, the whole cycle does not.

    Args:
        ksp: Set up.
        prefix: Of its options.
        tolerance: Relative one of the solves to come.
    """
    if tolerance < LEAST_TOLERANCE or ksp.comm.size > 1:
        return False
    pc = ksp.getPC()
    given = PETSc.Options().getAll()
    theirs = any(name.removeprefix(prefix).startswith(_THEIRS) for name in given)
    if theirs or ksp.getType() != PETSc.KSP.Type.CG or pc.getType() != PETSc.PC.Type.GAMG:
        return False
    levels = range(1, pc.getMGLevels())
    # Smoothers of the way down alone take the guess for zero.
    return len(levels) > 0 and all(
        pc.getMGSmoother(level).getInitialGuessNonzero() for level in levels
    )
