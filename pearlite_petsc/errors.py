"""Errors of the program; every message names the object, the value and the limit."""


class PearliteError(Exception):
    """Base of every error that the program raises on purpose."""


class SceneError(PearliteError):
    """The input (scene file, command line, output folder) cannot be used; exit status 2."""


class MeshError(PearliteError):
    """A microstructure or mesh cannot be built or read."""


class SolverError(PearliteError):
    """The equilibrium could not be found."""
