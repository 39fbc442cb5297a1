"""Stress intensity at a crack's tip, measured on the elements' displacements.

Williams' series of the displacements round a tip, with its crack along -x:

``2 mu u_x = sum_n r^(n/2) { a_n [(kappa + n/2 + (-1)^n) cos(n t/2) - n/2 cos((n/2 - 2) t)]
                           - b_n [(kappa + n/2 - (-1)^n) sin(n t/2) - n/2 sin((n/2 - 2) t)] }``
``2 mu u_y = sum_n r^(n/2) { a_n [(kappa - n/2 - (-1)^n) sin(n t/2) + n/2 sin((n/2 - 2) t)]
                           + b_n [(kappa - n/2 + (-1)^n) cos(n t/2) + n/2 cos((n/2 - 2) t)] }``

with K_I = sqrt(2 pi) a_1, K_II = -sqrt(2 pi) b_1 and T = 4 a_2; n = 0 and b_2 are the rigid motion
(Williams 1957; in this form Ayatollahi and Nejati 2011, doi 10.1111/j.1460-2695.2010.01504.x).
n = -1 is what a shift of the tip adds to the first order: rigid elements put the tip of the elastic
field a share of their width off the last broken interface, for K_I and K_II not the same one. With
it K depends neither on the ring nor on the elements (``verify --only crack_tip``).
"""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import PearliteError

TERMS = 5
"""Highest power n of sqrt(r) in the series."""

FLANK = 0.85 * np.pi
"""Angle from the crack's direction beyond which elements are left out: beside a crooked crack they
may lie on the other side of its straight extension.
"""


@dataclass(frozen=True, slots=True)
class TipFields:
    """What the field round a tip amounts to.

    Attributes:
        k_1: K_I [MPa sqrt(um)].
        k_2: K_II [MPa sqrt(um)], positive where the shear stress ahead of the tip is.
        t_stress: T, the constant stress along the crack [MPa].
        misfit: Root mean square of what the series leaves, over that of the displacements without
            their rigid motion.
        elements: Elements that the fit rests on.
    """

    k_1: float
    k_2: float
    t_stress: float
    misfit: float
    elements: int


def fit_tip_fields(
    centre: FloatArray,
    displacement: FloatArray,
    tip: tuple[float, float],
    angle: float,
    inner: float,
    outer: float,
    youngs_modulus: float,
    poisson_ratio: float,
) -> TipFields:
    """Return K_I, K_II and T of a crack by least squares over a ring of elements.

    >>> x, y = np.meshgrid(np.linspace(-9.0, 9.0, 10), np.linspace(-9.0, 9.0, 10))
    >>> points = np.column_stack([x.ravel(), y.ravel()])
    >>> uniaxial = points * [1.0 / 200.0, -0.3 / 200.0]
    >>> fit = fit_tip_fields(points, uniaxial, (0.0, 0.0), 0.0, 2.0, 10.0, 200.0, 0.3)
    >>> f"T = {fit.t_stress:.6f} MPa, |K| < 1e-9: {abs(fit.k_1) + abs(fit.k_2) < 1e-9}"
    'T = 1.000000 MPa, |K| < 1e-9: True'

    Args:
        centre: Places of the elements [um]; (n, 2).
        displacement: Of those places [um]; (n, 2).
        tip: The crack's tip [um].
        angle: Of the crack's direction at the tip from the x-axis [rad].
        inner, outer: Radii of the ring [um]; the inner one leaves out the elements that resolve
            the tip badly, the outer one whatever is no straight crack in an elastic body.
        youngs_modulus: E of plane stress [MPa].
        poisson_ratio: The one that the elements show, 0 with ``homogeneous`` springs.

    Raises:
        PearliteError: The ring holds too few elements for the series.
    """
    shear_modulus = 0.5 * youngs_modulus / (1.0 + poisson_ratio)
    kappa = (3.0 - poisson_ratio) / (1.0 + poisson_ratio)
    cos, sin = np.cos(angle), np.sin(angle)
    to_crack = np.array([[cos, -sin], [sin, cos]])
    place = (centre - tip) @ to_crack
    radius, turn = np.hypot(*place.T), np.arctan2(place[:, 1], place[:, 0])
    chosen = (radius >= inner) & (radius <= outer) & (np.abs(turn) <= FLANK)
    count = int(chosen.sum())
    unknowns = 2 * (TERMS + 2)
    if 2 * count < 2 * unknowns:
        raise PearliteError(
            f"ring of {inner:g} to {outer:g} um round the tip at ({tip[0]:g}, {tip[1]:g}) um holds "
            f"{count} elements, {unknowns} are needed to measure K"
        )
    scale = radius[chosen] / outer
    columns = _williams(scale, turn[chosen], kappa) / (2.0 * shear_modulus)
    moved = (displacement[chosen] @ to_crack).T.ravel()
    found, *_ = np.linalg.lstsq(columns, moved, rcond=None)
    a, b = found.reshape(2, -1)[:, 1:]
    rigid = columns[:, [1, TERMS + 3, TERMS + 5]] @ np.array([a[0], b[0], b[2]])
    left, strained = (float(np.linalg.norm(part - moved)) for part in (columns @ found, rigid))
    root = float(np.sqrt(2.0 * np.pi / outer))
    return TipFields(
        k_1=root * float(a[1]),
        k_2=-root * float(b[1]),
        t_stress=4.0 * float(a[2]) / outer,
        misfit=left / strained if strained > 0.0 else 0.0,
        elements=count,
    )


def _williams(radius: FloatArray, turn: FloatArray, kappa: float) -> FloatArray:
    """Return 2 mu (u_x of all, then u_y of all) of each a_n, then each b_n; (2 n, 2 terms)."""
    n = np.arange(-1, TERMS + 1)
    half, sign = 0.5 * n, (-1.0) ** n
    power = radius[:, None] ** half
    first, second = half * turn[:, None], (half - 2.0) * turn[:, None]
    opening_x = (kappa + half + sign) * np.cos(first) - half * np.cos(second)
    opening_y = (kappa - half - sign) * np.sin(first) + half * np.sin(second)
    sliding_x = -(kappa + half - sign) * np.sin(first) + half * np.sin(second)
    sliding_y = (kappa - half + sign) * np.cos(first) + half * np.cos(second)
    return np.block(
        [[power * opening_x, power * sliding_x], [power * opening_y, power * sliding_y]]
    )
