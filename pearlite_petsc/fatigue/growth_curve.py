"""Growth rate over Delta-K: apparent slope and threshold of a curve, ASTM E647."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from pearlite_petsc.arrays import FloatArray

THRESHOLD_RATE = 1e-10
"""da/dN at the threshold [m/cycle], ASTM E647 9.4."""

THRESHOLD_RANGE, THRESHOLD_POINTS = 1e-9, 5
"""Rates up to which points count for the threshold [m/cycle], and how many are needed."""


@dataclass(frozen=True, slots=True)
class PowerLaw:
    """da/dN = C Delta-K^m through some points.

    Attributes:
        slope: m.
        slope_error: Half width of its 95 % interval, NaN below three points.
        logarithm: ln C, da/dN and Delta-K in the units of the points.
        points: How many.
    """

    slope: float
    slope_error: float
    logarithm: float
    points: int

    def delta_k_at(self, rate: float) -> float:
        """Return Delta-K at which the law gives a rate."""
        return float(np.exp((np.log(rate) - self.logarithm) / self.slope))


def power_law(delta_k: FloatArray, rate: FloatArray) -> PowerLaw | None:
    """Return the straight line through log da/dN over log Delta-K, by least squares.

    >>> law = power_law(np.array([10.0, 20.0, 40.0]), 1e-11 * np.array([10.0, 20.0, 40.0]) ** 3)
    >>> f"m = {law.slope:.6f}"
    'm = 3.000000'

    Args:
        delta_k: Any unit; (p,).
        rate: Any unit; points that are not positive are passed over; (p,).

    Returns:
        The law, None where fewer than two Delta-K are left.
    """
    chosen = (rate > 0.0) & (delta_k > 0.0)
    x, y = np.log(delta_k[chosen]), np.log(rate[chosen])
    if len(np.unique(x)) < 2:
        return None
    span = x - x.mean()
    moment = float(span @ span)
    m = float(span @ y) / moment
    left = y - y.mean() - m * span
    error = np.nan
    if len(x) > 2:
        spread = np.sqrt(float(left @ left) / (len(x) - 2) / moment)
        error = float(student.ppf(0.975, len(x) - 2) * spread)
    return PowerLaw(m, error, float(y.mean() - m * x.mean()), len(x))


def threshold(delta_k: FloatArray, rate: FloatArray) -> float:
    """Return Delta-K_th of a measured curve, NaN where it does not reach down far enough.

    Delta-K at 1e-10 m/cycle on the straight line through at least five points between 1e-10 and
    1e-9 m/cycle, ASTM E647 9.4.

    Args:
        delta_k: [MPa sqrt(m)]; (p,).
        rate: da/dN [m/cycle]; (p,).
    """
    chosen = (rate >= THRESHOLD_RATE) & (rate <= THRESHOLD_RANGE)
    law = power_law(delta_k[chosen], rate[chosen])
    if law is None or law.points < THRESHOLD_POINTS or not law.slope > 0.0:
        return float("nan")
    return law.delta_k_at(THRESHOLD_RATE)
