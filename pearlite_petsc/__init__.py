"""Fatigue crack growth in sheared pearlitic rail steel by the discrete element method.

Examples:
    >>> import pearlite_petsc as pp
    >>> scene = pp.Scene(loading={"extension_um": 5.0})
    >>> mesh = pp.build_mesh(scene, "severe_AT", index=0)
    >>> crack = pp.grow_crack(mesh, delta_k_mpa_sqrt_m=18.0)
    >>> crack.stop_reason
    'grown'

Names end in their unit wherever a value has one. Whatever the program refuses or cannot compute
raises a ``PearliteError``. Importing the package starts neither MPI nor PETSc.
"""

import importlib
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pearlite_petsc.errors import PearliteError
    from pearlite_petsc.face.crack import Crack
    from pearlite_petsc.face.growth import Growth, Step, grow_crack
    from pearlite_petsc.face.mesh import Mesh, build_mesh
    from pearlite_petsc.face.results import Results, read_results
    from pearlite_petsc.face.run import run
    from pearlite_petsc.face.scene import Scene, load_scene
    from pearlite_petsc.face.table import Table

__version__ = "0.1.0"

__all__ = [
    "Crack",
    "Growth",
    "Mesh",
    "PearliteError",
    "Results",
    "Scene",
    "Step",
    "Table",
    "build_mesh",
    "grow_crack",
    "load_scene",
    "read_results",
    "run",
]

_HOME = {
    "Crack": "face.crack",
    "Growth": "face.growth",
    "Mesh": "face.mesh",
    "PearliteError": "errors",
    "Results": "face.results",
    "Scene": "face.scene",
    "Step": "face.growth",
    "Table": "face.table",
    "build_mesh": "face.mesh",
    "grow_crack": "face.growth",
    "load_scene": "face.scene",
    "read_results": "face.results",
    "run": "face.run",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__} has no attribute {name}")
    return getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return list(__all__)


class _Package(ModuleType):
    """The package, in which importing the command ``pearlite_petsc.run`` does not hide ``run``."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
