"""Growth rate da/dN from a crack's length over its cycles, as a laboratory evaluates it.

The measurements of a crack are the moments at which it got longer (``advances``): between them a
computed crack stands still while damage gathers, and a straight line through those rows as well
would depend on how often the program looked.
"""

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray

POLYNOMIAL_POINTS = 7


def advances(crack_length: FloatArray) -> BoolArray:
    """Return which rows of a history are measurements: the first, and each longer than all before.

    >>> advances(np.array([80.0, 80.0, 81.5, 81.0, 82.0])).tolist()
    [True, False, True, False, True]

    Args:
        crack_length: a [um]; shape (p,).
    """
    longest = np.maximum.accumulate(crack_length)
    return np.concatenate([[True], crack_length[1:] > longest[:-1]])


def slope(cycles: FloatArray, crack_length: FloatArray) -> float:
    """Return the least-squares slope of a over N [um/cycle] (the source), NaN without growth.

    Args:
        cycles: N, ascending; shape (p,).
        crack_length: a [um]; shape (p,).

    >>> slope(np.array([0.0, 1e3, 2e3]), np.array([80.0, 80.5, 81.0]))
    0.0005
    """
    span = cycles - cycles.mean()
    moment = float(span @ span)
    return float(span @ crack_length) / moment if moment > 0.0 else float("nan")


def secant(cycles: FloatArray, crack_length: FloatArray) -> FloatArray:
    """Return da/dN of the step that ended at each point, ASTM E647 X1.1 [um/cycle]; (p,).

    NaN for the first point, and where a step took no cycles.

    Args:
        cycles: N, ascending; shape (p,).
        crack_length: a [um]; shape (p,).
    """
    steps, rises = np.diff(cycles), np.diff(crack_length)
    rate = np.full(len(cycles), np.nan)
    np.divide(rises, steps, out=rate[1:], where=steps > 0.0)
    return rate


def incremental_polynomial(cycles: FloatArray, crack_length: FloatArray) -> FloatArray:
    """Return da/dN of the parabola through the seven points round each, ASTM E647 X1.2 [um/cycle].

    Args:
        cycles: N, ascending; shape (p,).
        crack_length: a [um]; shape (p,).

    Returns:
        Rate at each point, NaN for the first and last three and where fewer than three of the seven
        points differ in N; shape (p,).
    """
    half = POLYNOMIAL_POINTS // 2
    rates = np.full(len(cycles), np.nan)
    for middle in range(half, len(cycles) - half):
        window = slice(middle - half, middle + half + 1)
        n, a = cycles[window], crack_length[window]
        if len(np.unique(n)) < 3:
            continue
        centre, scale = 0.5 * (n[0] + n[-1]), 0.5 * (n[-1] - n[0])
        position = (n - centre) / scale
        quadratic, linear, _ = np.polyfit(position, a, 2)
        rates[middle] = (2.0 * quadratic * position[half] + linear) / scale
    return rates
