"""Krylov solver and preconditioner of one matrix: the project's settings, the user's word on top."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from pearlite_petsc.errors import SolverError
from pearlite_petsc.scene import Solver
from pearlite_petsc.solver.matrix import PLAIN_ROWS, StiffnessMatrix
from pearlite_petsc.solver.options import default_options, prefixed_options
from pearlite_petsc.solver.petsc import PETSc

PREFIX = "pearlite_"
FALLBACK_PREFIX = "pearlite_direct_"
COMPLIANCE_PREFIX = "pearlite_compliance_"

CG = {"ksp_type": "cg", "ksp_norm_type": "unpreconditioned", "ksp_max_it": "400"}

MULTIGRID = {
    "pc_type": "gamg",
    # One symmetric sweep smooths as well as three Chebyshev steps with blocks of the diagonal, at
    # half the products, and needs no estimate of eigenvalues.
    "mg_levels_ksp_type": "richardson",
    "mg_levels_ksp_max_it": "1",
    "mg_levels_pc_type": "sor",
    "mg_levels_pc_sor_omega": "1.1",
    # Lower on each coarser level, it keeps aggregates from reaching across a crack.
    "pc_gamg_threshold": "0.14,0.08,0.04,0.02",
    "pc_gamg_coarse_eq_limit": "1000",
    # For the smoothing of the prolongation.
    "pc_gamg_esteig_ksp_max_it": "5",
}

AGGREGATES = ("pc_gamg_square_graph", "pc_gamg_aggressive_coarsening")
"""Names, until PETSc 3.18 and since, of the number of levels with large aggregates."""

CHOLMOD = {
    "pc_type": "cholesky",
    "pc_factor_mat_solver_type": "cholmod",
    # Columns one by one and not by supernodes: nearly half the time of a solve on small meshes.
    "mat_cholmod_supernodal_switch": "80",
}

MOST_CHOLMOD = 2e5
"""Unknowns up to which factors of CHOLMOD are cheaper than those of MUMPS on one rank."""

MOST_AUTO_FACTORS = 3e4
"""Unknowns up to which ``auto`` takes old factors on one rank: their solves cost a third of GAMG's
at 1e4 and as much at 1e5, their set-up nearly twice as much there (``bench solver``).
"""


def method_of(settings: Solver, ranks: int, unknowns: int) -> str:
    """Return "iterative", "factors" or "direct" of a solver, ``auto`` by what is cheaper.

    Args:
        settings: Of the scene.
        ranks: Of the group.
        unknowns: Of the matrix.
    """
    if settings.method != "auto":
        return settings.method
    return "factors" if ranks == 1 and unknowns <= MOST_AUTO_FACTORS else "iterative"


def multigrid_settings(finer: bool = False) -> dict[str, str]:
    """Return the options of CG with GAMG, by name without prefix.

    Args:
        finer: Whether all levels have small aggregates. Two levels of large ones halve the set-up,
            but some cracks take them three times the iterations.
    """
    name = AGGREGATES[PETSc.Sys.getVersion() >= (3, 19)]
    return {**CG, **MULTIGRID, name: "0" if finer else "2"}


def factor_settings(ranks: int, unknowns: int) -> dict[str, str]:
    """Return the options of CG with factors of an earlier matrix as preconditioner.

    Args:
        ranks: Of the group.
        unknowns: Of the matrix.

    Raises:
        SolverError: Several ranks, and PETSc without MUMPS.
    """
    if ranks == 1 and unknowns <= MOST_CHOLMOD and _has("suitesparse"):
        return {**CG, **CHOLMOD}
    # Approximate minimum degree: elements numbered along a curve take it well, and the factors
    # cost a third less than with the orderings that MUMPS chooses.
    return {**direct_settings(ranks), **CG, "mat_mumps_icntl_7": "0"}


def repeatable_factor_settings(ranks: int, unknowns: int) -> dict[str, str]:
    """Return the options of factors whose solutions are the same bit for bit at every call.

    MUMPS on several ranks takes messages as they come and does not repeat itself: there the first
    rank factors alone.

    Args:
        ranks: Of the group.
        unknowns: Of the matrix.
    """
    settings = factor_settings(1, unknowns) | {"ksp_type": "preonly"}
    if ranks == 1:
        return settings
    gathered = {f"telescope_{name}": value for name, value in settings.items()}
    telescope = {"pc_type": "telescope", "pc_telescope_reduction_factor": str(ranks)}
    return {"ksp_type": "preonly", **telescope, **gathered}


def direct_settings(ranks: int) -> dict[str, str]:
    """Return the options of a direct solver: MUMPS where PETSc has it, else PETSc's Cholesky.

    Raises:
        SolverError: Several ranks, and PETSc without MUMPS.
    """
    settings = {"ksp_type": "preonly", "pc_type": "cholesky"}
    if _has("mumps"):
        settings["pc_factor_mat_solver_type"] = "mumps"
    elif ranks > 1:
        raise SolverError(
            f"direct solver on {ranks} ranks: this PETSc has no MUMPS; use one rank per task"
        )
    return settings


def _has(package: str) -> bool:
    return bool(PETSc.Sys.hasExternalPackage(package))


def may_coarsen_less(ksp: PETSc.KSP) -> bool:
    """Return whether the solver is multigrid and its user leaves the size of aggregates to us."""
    given = {name.removeprefix(PREFIX) for name in PETSc.Options().getAll()}
    return ksp.getPC().getType() == PETSc.PC.Type.GAMG and given.isdisjoint(AGGREGATES)


@contextmanager
def stage(name: str) -> Iterator[None]:
    """Log what runs inside under a stage of ``-log_view``."""
    log = PETSc.Log.Stage(name)
    log.push()
    try:
        yield
    finally:
        log.pop()


def make_solver(
    matrix: StiffnessMatrix,
    settings: Mapping[str, str],
    relative_tolerance: float,
    prefix: str = PREFIX,
) -> PETSc.KSP:
    """Return a solver that is set up for the matrix and keeps its preconditioner. Collective.

    Args:
        matrix: The matrix.
        settings: Options by name; plain options of the user win over them where the prefix is
            the main solver's.
        relative_tolerance: Of the unpreconditioned residual.
        prefix: Of the options.

    Raises:
        SolverError: PETSc does not know an option's value, or the set-up fails.
    """
    mat = matrix.mat
    # By way of the transposed prolongation the product is faster, on one rank where PETSc has it.
    products = {"matptap_via": "rap"} if mat.comm.size == 1 else {}
    ksp = PETSc.KSP().create(mat.comm)
    ksp.setOptionsPrefix(prefix)
    ksp.setOperators(mat)
    ksp.setTolerances(rtol=relative_tolerance)
    with (
        prefixed_options(prefix, settings, plain=prefix == PREFIX),
        default_options(products | PLAIN_ROWS),
    ):
        try:
            ksp.setFromOptions()
        except PETSc.Error as error:
            raise SolverError(f"PETSc refuses the options of the solver: {error}") from error
        ksp.setInitialGuessNonzero(ksp.getType() != PETSc.KSP.Type.PREONLY)
        try:
            ksp.setUp()
            if _sets_up_when_applied(ksp.pc):
                # Now, not after the damage has moved on, or a restarted run would differ.
                ones, scratch = mat.createVecs()
                ones.set(1.0)
                ksp.pc.apply(ones, scratch)
                ones.destroy()
                scratch.destroy()
        except PETSc.Error as error:
            ksp.destroy()
            raise SolverError(f"PETSc cannot set up the preconditioner: {error}") from error
    ksp.pc.setReusePreconditioner(True)
    return ksp


def _sets_up_when_applied(pc: PETSc.PC) -> bool:
    """Return whether the first application may estimate eigenvalues or make sub-solvers."""
    if pc.getType() != PETSc.PC.Type.GAMG:
        return pc.getType() not in (PETSc.PC.Type.CHOLESKY, PETSc.PC.Type.LU)
    levels = range(1, pc.getMGLevels())
    return any(pc.getMGSmoother(level).getType() == "chebyshev" for level in levels)
