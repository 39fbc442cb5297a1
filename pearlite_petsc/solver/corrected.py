"""Factors of an earlier matrix as preconditioner, corrected for the few interfaces that softened."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.solver.petsc import PETSc

Correction = Callable[[FloatArray], FloatArray]
"""Solution with the factors (n,) -> what is to be added to it; (n,)."""


@contextmanager
def corrected(ksp: PETSc.KSP, correction: Correction | None) -> Iterator[None]:
    """Let a solver on one rank add a correction to its preconditioner as long as this lasts."""
    if correction is None:
        yield
        return
    factors = ksp.getPC()
    # Not kept: PETSc cannot destroy it once Python has ended.
    pc = PETSc.PC().createPython(_Corrected(factors, correction), comm=ksp.comm)
    pc.setOperators(*factors.getOperators())
    ksp.setPC(pc)
    try:
        yield
    finally:
        ksp.setPC(factors)
        pc.destroy()


class _Corrected:
    """Context of PETSc's preconditioner type ``python``."""

    def __init__(self, factors: PETSc.PC, correction: Correction) -> None:
        self._factors, self._correction = factors, correction

    def apply(self, pc: PETSc.PC, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Put the preconditioned b into x."""
        self._factors.apply(b, x)
        found = x.getArray()
        found += self._correction(found)
