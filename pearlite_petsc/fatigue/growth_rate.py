"""Growth rate da/dN from a crack's length over its cycles."""

import numpy as np

from pearlite_petsc.arrays import FloatArray

POLYNOMIAL_POINTS = 7


def slope(cycles: FloatArray, crack_length: FloatArray) -> float:
    """Return the least-squares slope of a over N [um/cycle] (the source), NaN without growth.

    Args:
        cycles: N, ascending; shape (p,).
        crack_length: a [um]; shape (p,).
    """
    span = cycles - cycles.mean()
    moment = float(span @ span)
    return float(span @ crack_length) / moment if moment > 0.0 else float("nan")


def secant(cycles: FloatArray, crack_length: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return (mean a, da/dN) between successive points, ASTM E647 X1.1; shapes (p - 1,)."""
    steps = np.diff(cycles)
    moved = steps > 0.0
    rate = np.diff(crack_length)[moved] / steps[moved]
    middle = 0.5 * (crack_length[1:] + crack_length[:-1])[moved]
    return middle, rate


def incremental_polynomial(
    cycles: FloatArray, crack_length: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return (a, da/dN) of second-order polynomials over seven points each, ASTM E647 X1.2.

    Args:
        cycles: N, strictly ascending; shape (p,).
        crack_length: a [um]; shape (p,).

    Returns:
        Fitted a [um] and da/dN [um/cycle] at the middle points; shape (max(p - 6, 0),).
    """
    half = POLYNOMIAL_POINTS // 2
    lengths, rates = [], []
    for middle in range(half, len(cycles) - half):
        window = slice(middle - half, middle + half + 1)
        n, a = cycles[window], crack_length[window]
        centre, scale = 0.5 * (n[0] + n[-1]), 0.5 * (n[-1] - n[0])
        position = (n - centre) / scale
        quadratic, linear, constant = np.polyfit(position, a, 2)
        at = position[half]
        lengths.append(quadratic * at**2 + linear * at + constant)
        rates.append((2.0 * quadratic * at + linear) / scale)
    return np.array(lengths), np.array(rates)
