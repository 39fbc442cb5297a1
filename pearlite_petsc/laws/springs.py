"""Spring laws as plug-ins, and what they are given of the interfaces."""

from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray, guarded
from pearlite_petsc.laws.law import Law


@dataclass(frozen=True, slots=True, eq=False)
class SpringInterfaces:
    """Intact interfaces as a spring law sees them.

    Attributes:
        centre_distance: L_eq, distance between the elements' centres along the normal [um], > 0; (k,).
        length: Length L [um]; (k,).
        kind: ``Kind`` of each interface; (k,).
        midpoint: Midpoint [um]; (k, 2).
        normal: Unit normal from element i to j; (k, 2).
    """

    centre_distance: FloatArray
    length: FloatArray
    kind: IntArray
    midpoint: FloatArray
    normal: FloatArray

    def __post_init__(self) -> None:
        for entry in fields(self):
            values = getattr(self, entry.name)
            if isinstance(values, np.ndarray):
                # A law that changed them would change the mesh.
                object.__setattr__(self, entry.name, guarded(values))


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringLaw(Law):
    """A spring law: ``function(interfaces, material, *, parameters...) -> Stiffness``.

    The function gets ``SpringInterfaces`` and the scene's ``Material`` table and returns the
    normal and tangential stiffness per area of intact springs (``mechanics.springs.Stiffness``).

    Attributes:
        meets_poisson_ratio: Whether the function also takes ``ratio``, the k_t/k_n with which the
            mesh shows the material's Poisson ratio; the program finds it.
        poisson_ratio: The Poisson ratio that every mesh shows with this law, if it also shows the
            material's Young's modulus; None if its constants differ from mesh to mesh. K at the
            tip is measured only where the constants are known.
    """

    meets_poisson_ratio: bool = False
    poisson_ratio: float | None = None

    table: ClassVar[str] = "material"
    key: ClassVar[str] = "springs"
    arguments: ClassVar[tuple[str, ...]] = ("interfaces", "material")

    @property
    def given_by_program(self) -> tuple[str, ...]:
        """Keywords that the program passes besides the parameters."""
        return ("ratio",) if self.meets_poisson_ratio else ()
