"""PETSc, started by whatever imports it first."""

from pearlite_petsc.solver.start import start_petsc

start_petsc([])

from petsc4py import PETSc  # noqa: E402

__all__ = ["PETSc"]
