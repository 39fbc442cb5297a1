"""K at the tip of growing cracks, as every crack's history has it."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.output.tables import GROWTH_COLUMNS
from tests.scenes import STATES, default_scene

SMALL: dict[str, Any] = {
    "window": {"width": 140.0, "height": 140.0, "notch": 56.0},
    "elements": {"radius": 18.0},
    "loading": {"extension": 16.0},
    "cycle_jump": {"method": "compliance", "delta_d": 1.0},
    "solver": {"method": "factors"},
}


def grow(state: str = "severe_AT", delta_k: float = 18e3, **changes: Any) -> Outcome:
    parts = {name: SMALL.get(name, {}) | changes.get(name, {}) for name in {*SMALL, *changes}}
    scene = default_scene(**parts)
    steel = replace(STATES[state], delta_k_th=0.0)
    prepared = prepare_growth(scene, steel, 0)
    found = CrackGrowth(MPI.COMM_SELF, scene, steel, delta_k, prepared).grown()
    assert found is not None
    return found


def columns(outcome: Outcome) -> dict[str, FloatArray]:
    assert outcome.history is not None
    return dict(zip(GROWTH_COLUMNS, outcome.history.T, strict=True))


def test_the_notch_has_the_k_that_is_asked_for() -> None:
    found = columns(grow(loading={"extension": 4.0}))
    assert found["k_1_over_delta_k"][0] == pytest.approx(1.0, abs=0.01)
    assert found["k_2_over_delta_k"][0] == pytest.approx(0.0, abs=0.005)
    assert found["k_misfit"][0] < 0.005


def test_breaks_ahead_of_the_tip_show_as_misfit() -> None:
    found = columns(grow())
    advanced = np.diff(found["crack_length_um"], prepend=0.0) > 0.0
    # Rows that broke something and did not bring the tip on: what broke lies ahead of it.
    assert found["k_misfit"][~advanced].min() > 2.0 * found["k_misfit"][0]
    assert found["k_1_over_delta_k"][~advanced].min() > 1.05


def test_k_at_the_tip_goes_with_the_load_and_its_misfit_does_not() -> None:
    one, two = (columns(grow(delta_k=value)) for value in (18e3, 36e3))
    for name in ("k_1_over_delta_k", "k_2_over_delta_k", "k_misfit"):
        assert two[name] == pytest.approx(one[name], abs=1e-5)


@pytest.mark.parametrize(
    "changes",
    [
        {"material": {"springs": "raje"}},
        {"material": {"springs": "matched"}},
        {"elements": {"shear": "affine", "refinement": "uniform"}},
    ],
)
def test_where_the_elastic_constants_are_unknown_k_is_not_measured(changes: Any) -> None:
    changes = {**changes, "loading": {"extension": 4.0}}
    found = columns(grow("moderate_AT", **changes))
    for name in ("k_1_over_delta_k", "k_2_over_delta_k", "k_misfit"):
        assert np.isnan(found[name]).all()
