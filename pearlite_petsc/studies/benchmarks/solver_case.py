"""One method on one body, in a process group of its own, so that its peak memory is its own."""

import json
import pickle
import resource
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.config import load_scene_text
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.mesh import Mesh

if TYPE_CHECKING:
    from mpi4py import MPI

    from pearlite_petsc.solver.matrix import StiffnessMatrix
    from pearlite_petsc.solver.subdomain import Subdomain

FIRST_TOLERANCE, WARM_TOLERANCE = 1e-8, 1e-6
UPDATES = 3
"""Changes of damage with a warm solve after each; one where a solve takes longer than ``SLOW``."""

SLOW = 10.0

MOST_REPEATS, ENOUGH_SECONDS = 6, 20.0
DELTA_K = 12e3
STATE = "undeformed"


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """What one rank needs of a body with a notch half through.

    Attributes:
        subdomain: This rank's.
        tip: Of the notch [um].
        breaks: Interface that each update breaks; (u,).
    """

    subdomain: "Subdomain"
    tip: tuple[float, float]
    breaks: IntArray


def write_bodies(folder: Path, unknowns: float, ranks: tuple[int, ...]) -> int:
    """Make a uniformly fine mesh and write each rank's body; return its number of unknowns.

    Args:
        folder: Receives ``<ranks>_<rank>.pickle``.
        unknowns: About as many.
        ranks: Numbers of ranks to divide it for.
    """
    from pearlite_petsc.mechanics.springs import spring_stiffness
    from pearlite_petsc.solver.subdomain import element_ranges, subdomain_of
    from pearlite_petsc.tessellation.build import build_mesh

    elements = load_scene_text("", "bench").elements
    size = np.sqrt(unknowns / 3.0 * elements.width * elements.length)
    overrides = [f"window.{side}_um={size:.6g}" for side in ("width", "height")]
    overrides += [f"window.notch_um={0.5 * size:.6g}", "loading.extension_um=5"]
    scene = load_scene_text("", "bench", [*overrides, "elements.refinement=uniform"])
    mesh = build_mesh(scene, next(state for state in scene.states if state.name == STATE), 0)
    stiffness = spring_stiffness(mesh, scene.material)
    breaks = _ahead(mesh)
    for count in ranks:
        for rank, ends in enumerate(element_ranges(mesh.element_count, count)):
            body = Body(subdomain_of(mesh, stiffness, *ends), mesh.notch, breaks)
            with (folder / f"{count}_{rank}.pickle").open("wb") as stream:
                pickle.dump(body, stream)
    return 3 * mesh.element_count


def _ahead(mesh: Mesh) -> IntArray:
    """Return interfaces ahead of the notch that a crack could take, one after the other."""
    gap = mesh.midpoint - mesh.notch
    level = (np.abs(mesh.normal[:, 1]) > 0.7) & (gap[:, 0] > 0.0) & (mesh.kind != Kind.NOTCH)
    cost = np.where(level, gap[:, 0] + 4.0 * np.abs(gap[:, 1]), np.inf)
    return np.argsort(cost, kind="stable")[:UPDATES]


class Method(Protocol):
    """A solver of one matrix that keeps its preconditioner."""

    def set_up(self) -> None:
        """Make the preconditioner anew. Collective."""

    def solve(self, load: FloatArray, tolerance: float, warm: bool) -> int:
        """Solve, from the last solution if warm; return the iterations. Collective."""

    def residual(self, load: FloatArray) -> float:
        """Return the relative residual of the last solution. Collective."""

    def update(self, damage: FloatArray) -> None:
        """Give the matrix a new damage and keep the preconditioner. Collective."""


class WithPetsc:
    """CG of PETSc with a preconditioner by name."""

    def __init__(self, matrix: "StiffnessMatrix", name: str) -> None:
        from pearlite_petsc.solver.krylov import (
            CG,
            direct_settings,
            factor_settings,
            multigrid_settings,
        )

        unknowns = matrix.mat.getSize()[0]
        more = {**CG, "ksp_max_it": "5000"}
        self._settings = {
            "default": multigrid_settings(),
            "factors": factor_settings(matrix.mat.comm.size, unknowns),
            "GAMG": {**more, "pc_type": "gamg"},
            "hypre": {**more, "pc_type": "hypre", "pc_hypre_type": "boomeramg"},
            # As preconditioner of CG old factors are still good for a few new breaks.
            "MUMPS": {**direct_settings(1), **more},
        }[name]
        self._matrix = matrix
        self._x, self._b = matrix.mat.createVecs()
        self._halves = name == "default"
        self._ksp: Any = None
        self._upward: Any = None

    def set_up(self) -> None:
        """Make the preconditioner anew. Collective."""
        from pearlite_petsc.solver.half_cycle import HalfCycle, allows_half_cycle
        from pearlite_petsc.solver.krylov import PREFIX, make_solver

        for old in (self._upward, self._ksp):
            if old is not None:
                (old.close if old is self._upward else old.destroy)()
        self._ksp = make_solver(self._matrix, self._settings, FIRST_TOLERANCE)
        self._upward = None
        if self._halves and allows_half_cycle(self._ksp, PREFIX, WARM_TOLERANCE):
            self._upward = HalfCycle(self._ksp, PREFIX)

    def solve(self, load: FloatArray, tolerance: float, warm: bool) -> int:
        """Solve, from the last solution if warm; return the iterations. Collective."""
        self._b.setArray(load.ravel())
        if not warm:
            self._x.set(0.0)
        self._ksp.setTolerances(rtol=tolerance)
        before = 0
        if warm and self._upward is not None:
            before, converged = self._upward.solve(self._b, self._x)
            if converged:
                return int(before)
        self._ksp.solve(self._b, self._x)
        if self._ksp.getConvergedReason() < 0:
            return -1
        return before + int(self._ksp.getIterationNumber())

    def residual(self, load: FloatArray) -> float:
        """Return the relative residual of the last solution. Collective."""
        self._b.setArray(load.ravel())
        rest = self._b.duplicate()
        self._matrix.mat.mult(self._x, rest)
        rest.axpy(-1.0, self._b)
        value = float(rest.norm() / self._b.norm())
        rest.destroy()
        return value

    def update(self, damage: FloatArray) -> None:
        """Give the matrix a new damage and keep the preconditioner. Collective."""
        self._matrix.update(damage)


class WithPyamg:
    """CG and smoothed aggregation of PyAMG with the rigid modes, on one rank."""

    def __init__(self, matrix: "StiffnessMatrix", subdomain: "Subdomain") -> None:
        from pearlite_petsc.mechanics.kinematics import rigid_modes

        self._matrix = matrix
        modes = rigid_modes(
            subdomain.centre, subdomain.rotation_length, subdomain.centre.mean(axis=0)
        )
        self._modes = modes.reshape(-1, 3)
        self._x = np.zeros(len(self._modes))
        self._hierarchy: Any = None
        self._k: Any = None

    def set_up(self) -> None:
        """Make the hierarchy anew."""
        from pyamg import smoothed_aggregation_solver

        # The caller's sign of zero divisions inside is not PyAMG's.
        with np.errstate(all="ignore"):
            self._hierarchy = smoothed_aggregation_solver(self._k, B=self._modes)

    def solve(self, load: FloatArray, tolerance: float, warm: bool) -> int:
        """Solve, from the last solution if warm; return the iterations."""
        from pyamg.krylov import cg

        guess = self._x if warm else np.zeros_like(self._x)
        history: list[float] = []
        with np.errstate(all="ignore"):
            self._x, status = cg(
                self._k,
                load.ravel(),
                guess,
                tol=tolerance,
                maxiter=5000,
                M=self._hierarchy.aspreconditioner(),
                residuals=history,
            )
        return len(history) - 1 if status == 0 else -1

    def residual(self, load: FloatArray) -> float:
        """Return the relative residual of the last solution."""
        b = load.ravel()
        return float(np.linalg.norm(b - self._k @ self._x) / np.linalg.norm(b))

    def update(self, damage: FloatArray) -> None:
        """Give the matrix a new damage and keep the hierarchy."""
        self._matrix.update(damage)

    def take_matrix(self) -> None:
        """Bring the matrix into PyAMG's format, which is not its to be timed."""
        from scipy.sparse import csr_matrix

        offsets, columns, values = self._matrix.mat.getValuesCSR()
        size = (len(self._x), len(self._x))
        self._k = csr_matrix((values, columns, offsets), shape=size).tobsr(blocksize=(3, 3))


def missing(method: str) -> str:
    """Return why a method cannot be measured here, empty if it can."""
    from pearlite_petsc.solver.petsc import PETSc

    package = {"hypre": "hypre", "MUMPS": "mumps"}.get(method)
    if package and not PETSc.Sys.hasExternalPackage(package):
        return f"this PETSc has no {method}"
    if method == "PyAMG" and find_spec("pyamg") is None:
        return "PyAMG is not installed"
    return ""


def measure(comm: "MPI.Comm", body: Body, method: str, cracked: bool) -> dict[str, float]:
    """Return iterations, processor times [s] and residual of one method on one body. Collective.

    Args:
        comm: The ranks.
        body: This rank's.
        method: "default", "factors", "GAMG", "hypre", "MUMPS" or "PyAMG".
        cracked: Whether the notch is open; otherwise the body is intact.
    """
    from mpi4py import MPI

    from pearlite_petsc.solver.matrix import StiffnessMatrix

    subdomain = body.subdomain
    damage = ((subdomain.kind == Kind.NOTCH) & cracked).astype(float)
    load = _load(body)

    def timed(run: Callable[[], Any]) -> tuple[float, Any]:
        comm.Barrier()
        started = process_time()
        value = run()
        return float(comm.allreduce(process_time() - started, MPI.MAX)), value

    matrix: StiffnessMatrix
    assemble, matrix = timed(
        lambda: StiffnessMatrix(comm, subdomain, subdomain.jump_operator(), damage)
    )
    with matrix:
        solver: Method = (
            WithPyamg(matrix, subdomain) if method == "PyAMG" else WithPetsc(matrix, method)
        )
        if isinstance(solver, WithPyamg):
            solver.take_matrix()
        tries: list[tuple[float, float]] = []
        while len(tries) < MOST_REPEATS and np.sum(tries) < ENOUGH_SECONDS:
            setup, _ = timed(solver.set_up)
            first, iterations = timed(lambda: solver.solve(load, FIRST_TOLERANCE, warm=False))
            tries.append((setup, first))
        setup, first = map(min, zip(*tries, strict=True))
        residual = solver.residual(load)
        solver.solve(load, WARM_TOLERANCE, warm=False)
        warm, warm_iterations = 0.0, []
        breaks = body.breaks[:1] if first > SLOW else body.breaks
        for number in breaks:
            damage = np.where(subdomain.interface_numbers == number, 1.0, damage)
            update, _ = timed(lambda damage=damage: solver.update(damage))  # type: ignore[misc]
            if isinstance(solver, WithPyamg):
                solver.take_matrix()
            seconds, count = timed(lambda: solver.solve(load, WARM_TOLERANCE, warm=True))
            warm += (update + seconds) / len(breaks)
            warm_iterations.append(count)
    return {
        "unknowns": 3 * subdomain.element_count,
        "assemble_s": assemble,
        "iterations": iterations,
        "setup_s": setup,
        "first_solve_s": first,
        "solution_s": setup + first,
        "warm_solve_s": warm,
        "warm_iterations": float(np.mean(warm_iterations)) if min(warm_iterations) >= 0 else -1.0,
        "residual": residual,
    }


def _load(body: Body) -> FloatArray:
    """Return the tractions of a K field on owned elements, moments over the rotation length [uN]."""
    from pearlite_petsc.mechanics.loads import element_forces, williams_mode_one

    subdomain, airy = body.subdomain, williams_mode_one(DELTA_K, body.tip)
    own = subdomain.centre[: subdomain.owned_count]
    load = element_forces(
        subdomain.facet_start, subdomain.facet_end, subdomain.boundary_elements, own, airy
    )
    return load / [1.0, 1.0, subdomain.rotation_length]


def write_case(comm: "MPI.Comm", folder: Path, method: str, result: Path) -> None:
    """Measure a method on an intact and a cracked body; the first rank writes both as JSON.

    Collective.

    Args:
        comm: The ranks.
        folder: Of the bodies that ``write_bodies`` made for that many ranks.
        method: As for ``measure``.
        result: File to write.
    """
    why = missing(method)
    found: list[dict[str, Any]] = []
    if not why:
        name = f"{comm.size}_{comm.rank}.pickle"
        with (folder / name).open("rb") as stream:
            body: Body = pickle.load(stream)
        for cracked in (False, True):
            found.append({"crack": "half" if cracked else "none"})
            found[-1] |= measure(comm, body, method, cracked)
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    most = max(comm.allgather(own))
    if comm.rank == 0:
        rows = [row | {"memory_mib_per_rank": most} for row in found]
        result.write_text(json.dumps({"missing": why, "rows": rows}), encoding="utf-8")
