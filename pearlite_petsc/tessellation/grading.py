"""How large elements may be: fine in a zone, larger away from it, small enough at the notch."""

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.scene import Elements, Window
from pearlite_petsc.tessellation.nuclei import notch_band
from pearlite_petsc.tessellation.wake import STEEPER, Wake
from pearlite_petsc.tessellation.zone import FineZone

FLANK_FACTOR, FLANK_GROWTH = 2.0, 0.3
"""Coarsest spacing along the notch, as a multiple of the fine one, and its growth per um."""


def spacing_factor(
    elements: Elements, zone: FineZone, wake: Wake | None, points: FloatArray
) -> FloatArray:
    """Return the spacing over the fine one that places allow, the notch aside; (n,)."""
    factor = 1.0 + elements.coarsening * zone.distance(points)
    if wake is not None:
        gap = wake.distance_from_staying(points, elements.length)
        factor = np.minimum(factor, 1.0 + STEEPER * elements.coarsening * gap)
    return np.minimum(factor, max(elements.coarsest, 1.0))


def notch_guard(points: FloatArray, window: Window, elements: Elements) -> FloatArray:
    """Return the spacing factor up to which the notch stays straight and its tip where it is.

    Elements at the notch must find their neighbours inside the band of mirror nuclei, and
    refinement must not move the tip.
    """
    away = np.hypot(
        np.maximum(points[:, 0] - window.notch, 0.0), points[:, 1] - 0.5 * window.height
    )
    tip = np.hypot(points[:, 0] - window.notch, points[:, 1] - 0.5 * window.height)
    flank = FLANK_FACTOR + FLANK_GROWTH * np.maximum(away - notch_band(elements), 0.0)
    return np.minimum(flank, 1.0 + FLANK_GROWTH * np.maximum(tip - 2.0 * elements.length, 0.0))
