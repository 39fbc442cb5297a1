"""PETSc options of one solver: own prefix, plain options of the user accepted, his word wins."""

import ctypes
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from pearlite_petsc.solver.petsc import PETSc

_PASSED_ON: dict[str, bool] = {}

_FAMILIES = ("ksp_", "pc_", "mg_", "mat_", "sub_")


@contextmanager
def prefixed_options(
    prefix: str,
    defaults: Mapping[str, str],
    plain: bool = True,
) -> Iterator[None]:
    """Put the options of a solver into the database under its prefix, and take them out after.

    The order of who wins: ``-<prefix><name>`` of the user, ``-<name>`` of the user, the default.

    Args:
        prefix: The solver's prefix.
        defaults: Options by name, without prefix.
        plain: Whether the user's plain options are meant for this solver too.
    """
    options = PETSc.Options()
    wanted = {prefix + name: value for name, value in defaults.items()}
    given = [n for n in options.getAll() if n.startswith(_FAMILIES)] if plain else []
    # getString marks the plain option as used, which keeps -options_left clean.
    wanted |= {prefix + name: options.getString(name) for name in given}
    with default_options(wanted):
        yield
        for name in given:
            _PASSED_ON[name] = _PASSED_ON.get(name, False) or is_used(prefix + name)


def passed_on() -> Mapping[str, bool]:
    """Return the user's plain options that a solver was offered, and whether one asked for them."""
    return _PASSED_ON


def is_used(name: str) -> bool:
    """Return whether anything in PETSc has asked for an option.

    petsc4py does not tell, so PETSc's own function is called.
    """
    library = ctypes.CDLL(PETSc.__file__)
    # PetscBool is an int or, in newer versions, a byte.
    flag = ctypes.c_int(0)
    library.PetscOptionsUsed(None, name.encode(), ctypes.byref(flag))
    return bool(flag.value & 0xFF)


@contextmanager
def default_options(wanted: Mapping[str, str]) -> Iterator[None]:
    """Put options by their whole names into the database where the user gives none, and out after."""
    options = PETSc.Options()
    given = options.getAll()
    added = [name for name in wanted if name not in given]
    for name in added:
        options.setValue(name, wanted[name])
    try:
        yield
    finally:
        for name in added:
            options.delValue(name)
