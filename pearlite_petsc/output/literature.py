"""Growth laws and limits from the literature, drawn beside the results.

Delta-K in MPa sqrt(m), da/dN in m/cycle.
"""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class GrowthLaw:
    """A straight line da/dN = factor Delta-K^exponent."""

    name: str
    factor: float
    exponent: float

    def rate(self, delta_k: FloatArray) -> FloatArray:
        """Return da/dN [m/cycle] at Delta-K [MPa sqrt(m)]; shape (n,)."""
        return np.asarray(self.factor * delta_k**self.exponent)


@dataclass(frozen=True, slots=True)
class GrowthLimit:
    """Largest rate that a standard allows at one Delta-K."""

    delta_k: float
    rate: float


GROWTH_LAWS = (
    GrowthLaw("ferritic-pearlitic steels (Barsom)", 6.9e-12, 3.0),
    GrowthLaw("BS 7910, simplified upper line", 1.65e-11, 3.0),
)

RAIL_LIMITS = (GrowthLimit(10.0, 1.7e-8), GrowthLimit(13.5, 5.5e-8))
RAIL_LIMITS_RATIO = 0.5
"""EN 13674-1, and its load ratio."""


def rail_limits_name(load_ratio: float) -> str:
    """Return the limits' name beside rates computed at a load ratio, another than theirs said."""
    computed = "" if load_ratio == RAIL_LIMITS_RATIO else f"; computed: R = {load_ratio:g}"
    return f"EN 13674-1 limits (for R = {RAIL_LIMITS_RATIO:g}{computed})"
