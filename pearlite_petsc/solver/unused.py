"""Options of the user that nothing in PETSc asked for: misspelt, or of a solver that was not made.

PETSc keeps the list (``-options_left``); here it is read while the run can still say so.
"""

from collections.abc import Mapping
from difflib import get_close_matches

from pearlite_petsc.solver.krylov import (
    CG,
    CHOLMOD,
    COMPLIANCE_PREFIX,
    FALLBACK_PREFIX,
    MULTIGRID,
)
from pearlite_petsc.solver.options import is_used, passed_on
from pearlite_petsc.solver.petsc import PETSc

_LATE = ("log_", "options_", "malloc_", "memory_", "objects_", "get_total_flops", "no_signal")
"""Beginnings of names that PETSc looks at when it ends."""

_RARE = (FALLBACK_PREFIX, COMPLIANCE_PREFIX)
"""Prefixes of solvers that not every crack makes."""

_KNOWN = {*CG, *MULTIGRID, *CHOLMOD, "ksp_rtol", "ksp_monitor", "ksp_view", "mat_type", "log_view"}


def unused_options() -> list[str]:
    """Return the names of the user's options that nothing asked for so far."""
    options: Mapping[str, str] = PETSc.Options().getAll()
    asked = passed_on()
    return [
        name
        for name in options
        if not name.startswith((*_LATE, *_RARE)) and not asked.get(name, is_used(name))
    ]


def unused_text(names: list[str]) -> str:
    """Return what a user is told of them in one line."""
    shown = []
    for name in names:
        near = get_close_matches(name, _KNOWN, 1, 0.8)
        shown.append(f"-{name}" + (f" (did you mean -{near[0]}?)" if near else ""))
    return f"PETSc options that nothing used: {', '.join(shown)}; the run was made without them"
