"""PETSc, initialized by whatever imports it first."""

from pearlite_petsc.solver.initialize import initialize_petsc

initialize_petsc([])

from petsc4py import PETSc  # noqa: E402

__all__ = ["PETSc"]
