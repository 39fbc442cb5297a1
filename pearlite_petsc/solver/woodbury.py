"""Factors of an earlier matrix as preconditioner, corrected for the few interfaces that softened."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.solver.petsc import PETSc

Correction = Callable[[FloatArray], FloatArray]
"""Solution with the factors (n,) -> what is to be added to it; (n,)."""


@dataclass(frozen=True, slots=True, eq=False)
class Woodbury:
    """What turns factors of one damage into those of another one of some interfaces, on one rank.

    By the formula of Sherman, Morrison and Woodbury, with the springs of s interfaces as the update
    of low rank.

    Attributes:
        place: Local numbers of the interfaces; (s,).
        damage: Of them, as the factors have it; (s,).
        constants: k_n l, k_t l, k_n l^3/12 of them, intact; (s, 3).
        compliance: Jumps of each to unit pairs of forces on each, at that damage; (3 s, 3 s).
        operator: B of them; (s, 3, 6).
        unknowns: Which unknowns B takes; (s, 6).
        columns: Solutions with the factors under the unit pairs, by columns; (n, 3 s).
    """

    place: IntArray
    damage: FloatArray
    constants: FloatArray
    compliance: FloatArray
    operator: FloatArray
    unknowns: IntArray
    columns: FloatArray

    def correction(self, damage: FloatArray) -> Correction | None:
        """Return the correction for a damage; None where there is nothing to correct.

        Args:
            damage: Of the rank's interfaces; (k,).
        """
        let_go = (self.constants * (damage[self.place] - self.damage)[:, None]).ravel()
        if not let_go.any():
            return None
        try:
            inverse = np.linalg.inv(np.eye(len(let_go)) - self.compliance * let_go)
        except np.linalg.LinAlgError:
            # What hung on them alone is loose; the factors as they are go on.
            return None
        system = let_go[:, None] * inverse

        def correction(solution: FloatArray) -> FloatArray:
            opened = self.operator @ solution[self.unknowns][:, :, None]
            return np.asarray(self.columns @ (system @ opened.ravel()))

        return correction


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
