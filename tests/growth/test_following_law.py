"""A crack whose law follows it goes on from a checkpoint as if nothing had happened."""

from dataclasses import replace
from itertools import islice

import numpy as np
from mpi4py import MPI

from pearlite_petsc.fatigue.damage import objective
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.growth.checkpoint import Checkpoint
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.laws import DamageInterfaces, DamageLaw, RateConstants
from pearlite_petsc.scene import Damage
from tests.scenes import STATES, default_scene


def fading(interfaces: DamageInterfaces, damage: Damage) -> RateConstants:
    """The law `objective`, slower the further away the crack is."""
    found = objective(interfaces, damage)
    return replace(found, factor=found.factor / (1.0 + interfaces.crack_distance / 4.0))


LAW = DamageLaw(name="fading", help="for tests", function=fading, follows_crack=True)
SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0},
    elements={"radius": 12.0},
    damage={"law": LAW},
    loading={"extension": 15.0},
)
STATE = STATES["severe_AT"]
PREPARED = prepare_growth(SCENE, STATE, 0)


def growth_of(checkpoint: Checkpoint | None = None) -> CrackGrowth:
    return CrackGrowth(MPI.COMM_SELF, SCENE, STATE, 18e3, PREPARED, checkpoint)


def assert_same(one: Outcome | None, other: Outcome | None) -> None:
    assert one is not None and other is not None
    assert one.history is not None and other.history is not None
    assert np.array_equal(one.history, other.history)
    assert one.da_dn == other.da_dn > 0.0
    assert len(one.history) > 8


def test_a_law_that_follows_the_crack_goes_on_from_a_checkpoint_bit_for_bit() -> None:
    whole = growth_of().grown()
    with growth_of() as growth:
        assert len(list(islice(growth.steps(), 5))) == 5
        checkpoint = growth.checkpoint()
    assert checkpoint is not None
    assert_same(growth_of(checkpoint).grown(), whole)
