"""PETSc options of one solver: own prefix, plain options of the user accepted, his word wins."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from pearlite_petsc.solver.petsc import PETSc

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
    for name in options.getAll() if plain else ():
        if name.startswith(_FAMILIES):
            # getString marks the plain option as used, which keeps -options_left clean.
            wanted[prefix + name] = options.getString(name)
    with default_options(wanted):
        yield


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
