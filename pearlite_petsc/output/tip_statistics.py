"""K at the tip over the Delta-K asked for: means over cracks, weighted by the growth that it drove."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.output.statistics import Estimate, mean_with_interval

MOST_MISFIT = 0.05
"""Misfit up to which the field round a tip is that of one crack tip."""


@dataclass(frozen=True, slots=True)
class TipRow:
    """One state at one Delta-K.

    Attributes:
        state: Name.
        delta_k: [MPa sqrt(um)].
        k_1: K_I over Delta-K, mean over the cracks with its 95 % interval.
        k_2: |K_II| over Delta-K, likewise.
        measured: Share of the growth with K measured well, all cracks together.
        cracks: Cracks in the means.
    """

    state: str
    delta_k: float
    k_1: Estimate
    k_2: Estimate
    measured: float
    cracks: int


def tip_rows(outcomes: Sequence[Outcome], states: Sequence[str]) -> list[TipRow]:
    """Return the rows of all states and Delta-K at which K was measured, in the order of states."""
    rows = []
    for state in states:
        own = [o for o in outcomes if o.state == state and o.history is not None]
        for level in sorted({o.delta_k for o in own}):
            cracks = [_of_crack(o.history) for o in own if o.delta_k == level]
            table = np.array(cracks).reshape(-1, 4)
            measured = table[table[:, 2] > 0.0]
            if not len(measured):
                continue
            rows.append(
                TipRow(
                    state,
                    level,
                    mean_with_interval(measured[:, 0].tolist()),
                    mean_with_interval(measured[:, 1].tolist()),
                    float(table[:, 2].sum() / table[:, 3].sum()),
                    len(measured),
                )
            )
    return rows


def _of_crack(history: FloatArray | None) -> tuple[float, float, float, float]:
    """Return mean K_I and |K_II| over Delta-K, and growth with K measured well and in all [um]."""
    assert history is not None
    growth = np.diff(history[:, 1])
    good = (history[:-1, 6] <= MOST_MISFIT) & (growth > 0.0)
    weight = growth[good]
    total = float(weight.sum())
    if not total > 0.0:
        return np.nan, np.nan, 0.0, float(growth.sum())
    one, two = (float(weight @ np.abs(history[:-1, column][good])) / total for column in (4, 5))
    return one, two, total, float(growth.sum())
