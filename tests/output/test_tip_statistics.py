from dataclasses import replace

import numpy as np
import pytest

from pearlite_petsc.fatigue.outcome import Outcome, StopReason
from pearlite_petsc.output.tip_statistics import tip_rows


def crack(mesh: int, *rows: tuple[float, float, float, float]) -> Outcome:
    """Return a crack from rows of length, K_I, K_II over Delta-K, misfit."""
    table = np.array(rows)
    history = np.zeros((len(table), 7))
    history[:, 1], history[:, 4:] = table[:, 0], table[:, 1:]
    return Outcome("severe_AT", mesh, 18e3, StopReason.GROWN, history=history)


ONE = crack(0, (80.0, 1.0, -0.1, 0.0), (82.0, 0.7, 0.2, 0.01), (88.0, 5.0, 5.0, 0.0))


def test_k_counts_by_the_growth_that_it_drove() -> None:
    (row,) = tip_rows([ONE], ["severe_AT"])
    assert row.k_1.value == pytest.approx((2.0 * 1.0 + 6.0 * 0.7) / 8.0)
    assert row.k_2.value == pytest.approx((2.0 * 0.1 + 6.0 * 0.2) / 8.0)
    assert (row.measured, row.cracks, row.delta_k) == (1.0, 1, 18e3)


def test_what_is_no_single_tip_is_left_out_and_counted() -> None:
    other = crack(1, (80.0, 0.9, 0.0, 0.0), (82.0, 3.0, 0.0, 0.2), (92.0, 1.0, 0.0, 0.0))
    (row,) = tip_rows([ONE, other], ["severe_AT"])
    assert row.k_1.value == pytest.approx(np.mean([6.2 / 8.0, 0.9]))
    assert row.measured == pytest.approx((8.0 + 2.0) / (8.0 + 12.0))
    assert row.k_1.low < row.k_1.value < row.k_1.high and row.cracks == 2


def test_where_k_was_not_measured_there_is_no_row() -> None:
    assert ONE.history is not None
    history = ONE.history.copy()
    history[:, 4:] = np.nan
    assert (
        tip_rows([replace(ONE, history=history), replace(ONE, history=None)], ["severe_AT"]) == []
    )
    still = crack(0, (80.0, 1.0, 0.0, 0.0), (80.0, 1.2, 0.0, 0.0))
    assert tip_rows([still], ["severe_AT"]) == []
