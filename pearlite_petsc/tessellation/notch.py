"""The notch as a run of facets."""

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.errors import MeshError
from pearlite_petsc.scene import Window


class NotchGapError(MeshError):
    """The facets on the notch line end before the tip.

    Attributes:
        start, end: x between which no facet lies on the line [um].
    """

    def __init__(self, message: str, start: float, end: float) -> None:
        super().__init__(message)
        self.start, self.end = start, end


def notch_run(
    vertices: FloatArray,
    facets: IntArray,
    mirrored: BoolArray,
    window: Window,
    spacing: float,
) -> tuple[BoolArray, tuple[float, float]]:
    """Return the facets of the notch and its tip.

    Args:
        vertices: [um]; (m, 2).
        facets: End vertices of the interfaces; (k, 2).
        mirrored: Which interfaces lie between a nucleus and its image across the notch; (k,).
        window: Size and nominal notch [um].
        spacing: Mean spacing of the fine nuclei [um].

    Returns:
        Which interfaces belong to the notch (k,), and where it ends (x, y) [um].

    Raises:
        NotchGapError: The facets do not reach from the window's edge to the nominal tip.
    """
    middle = 0.5 * window.height
    number = np.flatnonzero(mirrored)
    x = vertices[facets[number], 0]
    start, end = x.min(axis=1), x.max(axis=1)
    order = np.argsort(start)
    start, end, number = start[order], end[order], number[order]
    reached = np.concatenate([[0.0], end[:-1]])
    gaps = np.flatnonzero(start - reached > 1e-2 * spacing)
    run = int(gaps[0]) if len(gaps) else len(number)
    tip = float(end[run - 1]) if run else 0.0
    if abs(tip - window.notch) > 3.0 * spacing:
        raise NotchGapError(
            f"notch ends at x = {tip:.4g} um, more than {3.0 * spacing:.4g} um from "
            f"the {window.notch:g} um asked for",
            tip,
            float(start[run]) if run < len(number) else window.notch,
        )
    on_notch = np.zeros(len(facets), dtype=np.bool_)
    on_notch[number[:run]] = True
    return on_notch, (tip, middle)
