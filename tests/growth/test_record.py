"""What is counted of a crack, and the outcome that is made of it."""

import math

import numpy as np
import pytest

from pearlite_petsc.fatigue.outcome import Crack, Outcome, StopReason
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.growth.record import Record, new_record, outcome_of
from pearlite_petsc.mechanics.tip_fields import TipFields
from pearlite_petsc.scene import Kind
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0},
    elements={"width": 3.0, "length": 6.0, "refinement": "uniform"},
    microstructure={"prior_austenite_grain": 40.0, "block": 25.0, "colony": 5.0},
)
CASE = CrackCase(SCENE, STATES["undeformed"], 18e3)
MESH = prepare_growth(SCENE, CASE.state, 0).mesh


def grown() -> Record:
    record = new_record(25.0)
    for cycles, length in ((100.0, 28.0), (150.0, 28.0), (200.0, 31.0), (300.0, 34.0)):
        record = record.with_break(cycles, length, length - 25.0, int(cycles / 50.0))
    return record


def outcome(record: Record, stop: StopReason, length: float, cycles: float) -> Outcome:
    path = np.array([[25.0, 30.0], [length, 30.0]])
    crack = Crack(length, (length, 30.0), path, 1.25 * (length - 25.0), 6)
    damage = (MESH.kind == Kind.NOTCH).astype(float)
    damage[np.flatnonzero(damage == 0.0)[:2]] = 1.0
    loose = np.zeros(MESH.element_count, dtype=bool)
    loose[3] = True
    return outcome_of(CASE, stop, record, MESH, crack, cycles, damage, loose)


def test_the_growth_rate_is_the_slope_over_the_rows_where_the_crack_grew() -> None:
    found = outcome(grown(), StopReason.GROWN, 34.0, 300.0)
    # 25, 28, 31, 34 um at 0, 100, 200, 300 cycles; the row at 150 brought no length.
    assert found.da_dn == pytest.approx(0.03, rel=1e-12)
    assert found.extension == 9.0
    assert found.tortuosity == pytest.approx(1.25)
    assert found.history is not None and found.history[:, 0].tolist() == [0, 100, 150, 200, 300]


def test_an_arrested_crack_has_no_rate_and_lasts_until_its_last_cycle() -> None:
    found = outcome(grown(), StopReason.ARRESTED, 34.0, 400.0)
    assert math.isnan(found.da_dn)
    assert found.history is not None
    assert found.history[-1, :4].tolist() == [400.0, 34.0, 9.0, 6.0]


def test_what_is_measured_at_the_tip_belongs_to_the_last_row() -> None:
    record = grown()
    assert record.lacks_tip
    measured = record.with_tip(TipFields(16e3, -2e3, 10.0, 0.01, 90), 20e3)
    assert not measured.lacks_tip and record.lacks_tip
    assert measured.history[-1, 4:].tolist() == [0.8, -0.1, 0.01]
    assert np.isnan(measured.history[:-1, 4:]).all()
    assert measured.with_break(350.0, 36.0, 11.0, 7).lacks_tip


def test_a_crack_shorter_than_a_colony_has_no_tortuosity() -> None:
    assert outcome(new_record(25.0), StopReason.BOUNDARY, 29.9, 0.0).tortuosity is None


def test_counts_add_up_and_those_of_nothing_are_left_out() -> None:
    record = new_record(25.0).solved().solved().counting({"undone": 0, "iterations": 5})
    record = record.refined({"iterations": 4, "setups": 1})
    record = record.now({"iterations": 3}, 2.5).now({}, 0.5)
    assert (record.solves, record.refinements, record.wall_s) == (2, 1, 3.0)
    assert dict(record.counters) == {"iterations": 12, "setups": 1}
    found = outcome(record, StopReason.BOUNDARY, 29.0, 0.0)
    assert found.effort.counters == {"iterations": 12.0, "setups": 1.0, "loose_elements": 1.0}
    assert found.shape is not None and len(found.shape.broken_pairs) == 2
