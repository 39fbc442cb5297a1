"""Plain numbers on axes of Delta-K."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

DELTA_K_LABEL = r"$\Delta K$ [MPa$\sqrt{\mathrm{m}}$]"

PLAIN = (1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, 40, 60, 100, 150, 200, 300, 400, 600, 1000)
CLOSEST = 1.08
"""Ratio of two ticks from which their numbers do not touch on an axis of one decade."""


def plain_ticks(axes: Any, ticks: Sequence[float] = PLAIN) -> None:
    """Put plain numbers on a logarithmic x axis of Delta-K [MPa sqrt(m)].

    Args:
        axes: The axes, their limits set.
        ticks: Where; those too close to each other give way to ``PLAIN``.
    """
    limits = axes.get_xlim()
    closest = CLOSEST ** max(1.0, 1.6 * abs(math.log10(limits[1] / limits[0])))
    if any(high / low < closest for low, high in pairwise(sorted(ticks))):
        ticks = PLAIN
    axes.xaxis.set_major_locator(FixedLocator(list(ticks)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xlim(limits)
