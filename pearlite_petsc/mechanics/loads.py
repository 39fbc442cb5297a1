"""Boundary loads as forces and moments on elements.

Both loads come from an Airy stress function U: between two points of the boundary, passed
counter-clockwise, the force is (dU_y, -dU_x) and the moment about the origin is
d(U - x U_x - y U_y), d the difference between the end points. The sum round the window therefore
vanishes exactly, whatever the facets.
"""

from collections.abc import Callable

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray

AiryFunction = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Points (p, 2) [um] -> U [uN] of shape (p,) and its gradient [uN/um] of shape (p, 2)."""


def williams_mode_one(k: float, tip: tuple[float, float]) -> AiryFunction:
    """Return the Airy function of a mode-I crack along -x from ``tip``, faces free of traction.

    ``U = K/sqrt(2 pi) r^(3/2) (cos(theta/2) + cos(3 theta/2)/3)`` (Williams 1957).

    Args:
        k: Stress intensity factor [MPa sqrt(um)].
        tip: Crack tip [um].
    """
    factor = k / np.sqrt(2.0 * np.pi)

    def airy(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        x, y = points[:, 0] - tip[0], points[:, 1] - tip[1]
        r, angle = np.hypot(x, y), np.arctan2(y, x)
        half, three = 0.5 * angle, 1.5 * angle
        radial = 1.5 * np.sqrt(r) * (np.cos(half) + np.cos(three) / 3.0)
        hoop = -0.5 * np.sqrt(r) * (np.sin(half) + np.sin(three))
        cos, sin = np.cos(angle), np.sin(angle)
        gradient = np.stack([radial * cos - hoop * sin, radial * sin + hoop * cos], axis=1)
        return factor * radial * r / 1.5, factor * gradient

    return airy


def uniform_stress(xx: float, yy: float, xy: float) -> AiryFunction:
    """Return the Airy function of a uniform stress [MPa]."""

    def airy(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        x, y = points[:, 0], points[:, 1]
        value = 0.5 * (yy * x**2 + xx * y**2) - xy * x * y
        return value, np.stack([yy * x - xy * y, xx * y - xy * x], axis=1)

    return airy


def facet_forces(
    start: FloatArray, end: FloatArray, centre: FloatArray, airy: AiryFunction
) -> FloatArray:
    """Return what the stress function puts on each facet of the window's boundary.

    Args:
        start, end: Ends of the facets, counter-clockwise [um]; shape (q, 2) each.
        centre: Centre of each facet's element [um]; shape (q, 2).
        airy: Airy function of the load.

    Returns:
        (F_x, F_y, moment about the centre) [uN, uN, uN um]; shape (q, 3).
    """
    (u_0, g_0), (u_1, g_1) = airy(start), airy(end)
    turn = g_1 - g_0
    force = np.stack([turn[:, 1], -turn[:, 0]], axis=1)
    moment = (u_1 - np.einsum("qd,qd->q", end, g_1)) - (u_0 - np.einsum("qd,qd->q", start, g_0))
    moment -= centre[:, 0] * force[:, 1] - centre[:, 1] * force[:, 0]
    return np.column_stack([force, moment])


def element_forces(
    start: FloatArray, end: FloatArray, element: IntArray, centre: FloatArray, airy: AiryFunction
) -> FloatArray:
    """Return what the stress function puts on each element.

    Args:
        start, end: Ends of the boundary's facets, counter-clockwise [um]; shape (q, 2) each.
        element: Element of each facet; shape (q,).
        centre: Centres of all elements [um]; shape (n, 2).
        airy: Airy function of the load.

    Returns:
        (F_x, F_y, moment about the centre) [uN, uN, uN um]; shape (n, 3).
    """
    load = np.zeros((len(centre), 3))
    np.add.at(load, element, facet_forces(start, end, centre[element], airy))
    return load
