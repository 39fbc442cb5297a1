"""How a softening interface lets go of its force, against a spring in series written out."""

import numpy as np
import pytest

from pearlite_petsc.fatigue.release import SURROUNDINGS, next_release, released, stiffness_ratio

DAMAGE = np.linspace(0.0, 1.0, 11)


@pytest.mark.parametrize("stiffness", [0.05, 0.32, 2.0])
def test_released_force_is_that_of_two_springs_in_series(stiffness: float) -> None:
    ratio = float(stiffness_ratio(np.array([stiffness]))[0])

    def force(damage: float) -> float:
        soft = stiffness * (1.0 - damage)
        return soft * SURROUNDINGS / (soft + SURROUNDINGS)

    for damage in DAMAGE:
        gone = 1.0 - force(damage) / force(0.0)
        assert released(float(damage), ratio) == pytest.approx(gone, abs=1e-12)


@pytest.mark.parametrize("ratio", [0.0, 0.4, 0.9])
@pytest.mark.parametrize("failure", [1.0, 0.5])
def test_steps_to_failure_release_equal_forces(ratio: float, failure: float) -> None:
    damage, ratios, forces = np.zeros(1), np.array([ratio]), [0.0]
    while damage[0] < failure:
        damage = next_release(damage, ratios, failure, step=0.1)
        forces.append(float(released(damage, ratios)[0]))
    steps = np.diff(forces)
    assert steps == pytest.approx(np.full(len(steps), steps[0]), rel=1e-9)
    assert len(steps) == np.ceil(forces[-1] / 0.1 - 1e-9)
    assert steps[0] <= 0.1 + 1e-9
    assert damage[0] == failure


def test_two_steps_at_least_stop_half_way() -> None:
    ratios = np.array([0.6])
    whole = next_release(np.zeros(1), ratios, 1.0, step=1.0)
    half = next_release(np.zeros(1), ratios, 1.0, step=1.0, least_steps=2.0)
    assert whole.tolist() == [1.0]
    assert released(half, ratios) == pytest.approx([0.5])
