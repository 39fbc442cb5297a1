"""Solvers of one body: the program's own as growing cracks use it, and others to compare with."""

from importlib.util import find_spec
from typing import Any, Literal, Protocol

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import SolverError
from pearlite_petsc.mechanics.kinematics import rigid_modes
from pearlite_petsc.scene import Solver
from pearlite_petsc.solver.closing import Closing
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.krylov import CG, direct_settings, make_solver
from pearlite_petsc.solver.petsc import PETSc
from pearlite_petsc.solver.subdomain import Subdomain
from pearlite_petsc.solver.system import LinearSystem

FIRST_TOLERANCE, WARM_TOLERANCE = 1e-8, 1e-6

OWN: dict[str, Literal["iterative", "factors"]] = {"default": "iterative", "factors": "factors"}
"""Methods of scenes."""

OTHERS = {
    "GAMG": {"pc_type": "gamg"},
    "hypre": {"pc_type": "hypre", "pc_hypre_type": "boomeramg"},
    # As preconditioner of CG old factors are still good for a few new breaks.
    "MUMPS": direct_settings(1),
}
"""Options of PETSc."""


class Method(Protocol):
    """A solver that keeps its preconditioner while the damage moves on."""

    def set_up(self) -> None:
        """Make the preconditioner anew. Collective."""

    def first_solve(self, load: FloatArray) -> int:
        """Solve from zero to ``FIRST_TOLERANCE``; return the iterations, -1 in vain. Collective."""

    def residual(self) -> float:
        """Return the relative residual of the last solution. Collective."""

    def begin_warm(self, load: FloatArray) -> None:
        """Find the solution that the first warm solve starts from; not timed. Collective."""

    def update(self, damage: FloatArray) -> None:
        """Give the matrix a new damage (k,) and keep the preconditioner. Collective."""

    def prepare(self) -> None:
        """Do after an update what is not the method's to be timed. Collective."""

    def warm_solve(self, load: FloatArray) -> int:
        """Solve from the last solution to ``WARM_TOLERANCE``; as ``first_solve``. Collective."""

    def close(self) -> None:
        """Destroy what was made. Collective."""


class OwnMethod(Closing):
    """``Equilibrium``, with its own policy of renewing and of half cycles.

    Args:
        comm: The ranks.
        subdomain: This rank's.
        damage: At the start; (k,).
        name: In ``OWN``.
    """

    def __init__(self, comm: MPI.Comm, subdomain: Subdomain, damage: FloatArray, name: str) -> None:
        self._comm, self._subdomain, self._method = comm, subdomain, OWN[name]
        self._zero = np.zeros((subdomain.owned_count, 3))
        self._equilibrium = self._at(damage, FIRST_TOLERANCE)

    def _at(self, damage: FloatArray, tolerance: float) -> Equilibrium:
        settings = Solver(self._method, tolerance, 1)
        return Equilibrium(self._comm, self._subdomain, damage, settings)

    def set_up(self) -> None:
        """Make the preconditioner anew. Collective."""
        self._equilibrium.renew()

    def first_solve(self, load: FloatArray) -> int:
        """Solve from zero. Collective."""
        return self._solve(load, self._zero)

    def residual(self) -> float:
        """Return the relative residual. Collective."""
        return self._equilibrium.system.relative_residual()

    def begin_warm(self, load: FloatArray) -> None:
        """Go on with an equilibrium of the other tolerance. Collective."""
        damage = self._equilibrium.system.damage
        # First, or both would count as memory.
        self._equilibrium.close()
        self._equilibrium = self._at(damage, WARM_TOLERANCE)
        self._solve(load, self._zero)

    def update(self, damage: FloatArray) -> None:
        """Give the matrix a new damage. Collective."""
        self._equilibrium.update(damage)

    def prepare(self) -> None:
        """Do nothing."""

    def warm_solve(self, load: FloatArray) -> int:
        """Solve from the last solution. Collective."""
        return self._solve(load, None)

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        self._equilibrium.close()

    def _solve(self, load: FloatArray, guess: FloatArray | None) -> int:
        counters = self._equilibrium.counters
        before = counters["iterations"]
        try:
            self._equilibrium.solve(load, guess)
        except SolverError:
            return -1
        return counters["iterations"] - before


class PetscMethod(Closing):
    """CG of PETSc with a preconditioner by name.

    Args:
        system: The equations; closed with this.
        name: In ``OTHERS``.
    """

    def __init__(self, system: LinearSystem, name: str) -> None:
        self._system = system
        self._settings = {**OTHERS[name], **CG, "ksp_max_it": "5000"}
        self._ksp: Any = None

    def set_up(self) -> None:
        """Make the preconditioner anew. Collective."""
        if self._ksp is not None:
            self._ksp.destroy()
        self._ksp = make_solver(self._system.matrix, self._settings, FIRST_TOLERANCE)

    def first_solve(self, load: FloatArray) -> int:
        """Solve from zero. Collective."""
        self._system.x.set(0.0)
        return self._solve(load)

    def residual(self) -> float:
        """Return the relative residual. Collective."""
        return self._system.relative_residual()

    def begin_warm(self, load: FloatArray) -> None:
        """Solve from zero to the tolerance of warm solves. Collective."""
        self._ksp.setTolerances(rtol=WARM_TOLERANCE)
        self.first_solve(load)

    def update(self, damage: FloatArray) -> None:
        """Give the matrix a new damage. Collective."""
        self._system.update(damage)

    def prepare(self) -> None:
        """Do nothing."""

    def warm_solve(self, load: FloatArray) -> int:
        """Solve from the last solution. Collective."""
        return self._solve(load)

    def close(self) -> None:
        """Destroy the PETSc objects. Collective."""
        if self._ksp is not None:
            self._ksp.destroy()
        self._system.close()

    def _solve(self, load: FloatArray) -> int:
        self._system.set_load(load)
        self._ksp.solve(self._system.b, self._system.x)
        converged = self._ksp.getConvergedReason() > 0
        return int(self._ksp.getIterationNumber()) if converged else -1


class PyamgMethod(Closing):
    """CG and smoothed aggregation of PyAMG with the rigid modes, on one rank.

    Args:
        system: The equations; closed with this.
    """

    def __init__(self, system: LinearSystem) -> None:
        self._system = system
        here = system.subdomain
        modes = rigid_modes(here.centre, here.rotation_length, here.centre.mean(axis=0))
        self._modes = modes.reshape(-1, 3)
        self._x = np.zeros(len(self._modes))
        self._load = np.zeros(len(self._modes))
        self._hierarchy: Any = None
        self._k: Any = None
        self.prepare()

    def set_up(self) -> None:
        """Make the hierarchy anew."""
        from pyamg import smoothed_aggregation_solver

        # The caller's sign of zero divisions inside is not PyAMG's.
        with np.errstate(all="ignore"):
            self._hierarchy = smoothed_aggregation_solver(self._k, B=self._modes)

    def first_solve(self, load: FloatArray) -> int:
        """Solve from zero."""
        return self._solve(load, np.zeros_like(self._x), FIRST_TOLERANCE)

    def residual(self) -> float:
        """Return the relative residual."""
        rest = np.linalg.norm(self._load - self._k @ self._x)
        return float(rest / np.linalg.norm(self._load))

    def begin_warm(self, load: FloatArray) -> None:
        """Solve from zero to the tolerance of warm solves."""
        self._solve(load, np.zeros_like(self._x), WARM_TOLERANCE)

    def update(self, damage: FloatArray) -> None:
        """Give the matrix a new damage and keep the hierarchy."""
        self._system.update(damage)

    def prepare(self) -> None:
        """Bring the matrix into PyAMG's format."""
        from scipy.sparse import csr_matrix

        offsets, columns, values = self._system.matrix.mat.getValuesCSR()
        size = (len(self._x), len(self._x))
        self._k = csr_matrix((values, columns, offsets), shape=size).tobsr(blocksize=(3, 3))

    def warm_solve(self, load: FloatArray) -> int:
        """Solve from the last solution."""
        return self._solve(load, self._x, WARM_TOLERANCE)

    def close(self) -> None:
        """Destroy the PETSc objects."""
        self._system.close()

    def _solve(self, load: FloatArray, guess: FloatArray, tolerance: float) -> int:
        from pyamg.krylov import cg

        self._load = self._system.subdomain.right_hand_side(load)
        history: list[float] = []
        with np.errstate(all="ignore"):
            self._x, status = cg(
                self._k,
                self._load,
                guess,
                tol=tolerance,
                maxiter=5000,
                M=self._hierarchy.aspreconditioner(),
                residuals=history,
            )
        return len(history) - 1 if status == 0 else -1


def method_of(comm: MPI.Comm, subdomain: Subdomain, damage: FloatArray, name: str) -> Method:
    """Return a method by name for a body at a damage. Collective; close it.

    Args:
        comm: The ranks.
        subdomain: This rank's.
        damage: Of its interfaces; (k,).
        name: In ``OWN``, in ``OTHERS`` or "PyAMG".
    """
    if name in OWN:
        return OwnMethod(comm, subdomain, damage, name)
    system = LinearSystem(comm, subdomain, damage)
    return PyamgMethod(system) if name == "PyAMG" else PetscMethod(system, name)


def missing(method: str) -> str:
    """Return why a method cannot be measured here, empty if it can."""
    package = {"hypre": "hypre", "MUMPS": "mumps"}.get(method)
    if package and not PETSc.Sys.hasExternalPackage(package):
        return f"this PETSc has no {method}"
    if method == "PyAMG" and find_spec("pyamg") is None:
        return "PyAMG is not installed"
    return ""
