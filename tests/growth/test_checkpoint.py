"""A checkpoint is a value: taken from a crack, through a file and back, on one rank here.

``tests/mpi/test_restart.py`` kills runs; ``test_loop`` goes on bit for bit.
"""

from itertools import islice

import numpy as np
from mpi4py import MPI

from pearlite_petsc.ensemble.serialize import deserialize, serialize
from pearlite_petsc.growth.checkpoint import Checkpoint
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import prepare_growth
from tests.scenes import STATES, default_scene

SCENE = default_scene(
    window={"width": 60.0, "height": 60.0, "notch": 25.0},
    elements={"radius": 12.0},
    cycle_jump={"method": "exponential", "delta_d": 0.3},
)
PREPARED = prepare_growth(SCENE, STATES["severe_AT"], 0)


def growth_of(checkpoint: Checkpoint | None = None) -> CrackGrowth:
    return CrackGrowth(MPI.COMM_SELF, SCENE, STATES["severe_AT"], 18e3, PREPARED, checkpoint)


def saved_after(steps: int) -> Checkpoint:
    with growth_of() as growth:
        list(islice(growth.steps(), steps))
        checkpoint = growth.checkpoint()
    assert checkpoint is not None
    return checkpoint


def assert_same(one: Checkpoint, other: Checkpoint) -> None:
    (values, arrays), (others, other_arrays) = serialize(one), serialize(other)
    for each in (values, others):
        assert each["record"].pop("wall_s") >= 0.0
    assert values == others
    assert arrays.keys() == other_arrays.keys()
    assert all(array.tobytes() == other_arrays[name].tobytes() for name, array in arrays.items())


def test_what_is_restored_saves_the_same_again() -> None:
    checkpoint = saved_after(12)
    assert {"damage.memory.by_interface.exponent", "equilibrium.solution"} <= serialize(checkpoint)[
        1
    ].keys()
    with growth_of(deserialize(Checkpoint, *serialize(checkpoint))) as growth:
        again = growth.checkpoint()
    assert again is not None
    assert_same(again, checkpoint)


def test_a_checkpoint_is_not_changed_by_the_crack_that_goes_on_from_it() -> None:
    checkpoint = saved_after(12)
    before = deserialize(Checkpoint, *serialize(checkpoint))
    before = before.scattered(_Everywhere())  # type: ignore[arg-type]
    with growth_of(checkpoint) as growth:
        list(islice(growth.steps(), 5))
    assert_same(checkpoint, before)


class _Everywhere:
    """A domain whose one rank has everything, and gets copies."""

    comm = MPI.COMM_SELF

    def scatter(self, values: np.ndarray) -> np.ndarray:
        return values.copy()

    scatter_elements = scatter


def test_without_arrays_nothing_large_is_left_to_be_sent() -> None:
    checkpoint = saved_after(12)
    light = checkpoint.without_arrays()
    sizes = {name: array.size for name, array in serialize(light)[1].items()}
    assert sizes["damage.damage"] == sizes["equilibrium.solution"] == 0
    assert "refinement.kept" not in sizes
    # What every rank needs whole stays.
    assert sizes["record.history"] == checkpoint.record.history.size > 0
    assert sizes["refinement.zone.discs"] > 0
    assert light.damage.cycles == checkpoint.damage.cycles > 0.0


def test_gathered_is_what_was_scattered() -> None:
    checkpoint = saved_after(12)
    mesh = PREPARED.mesh if not checkpoint.record.refinements else None
    mesh = mesh or checkpoint.refinement.mesh(PREPARED.substrate)
    with Domain(MPI.COMM_SELF, SCENE, mesh, PREPARED.ratio) as domain:
        back = checkpoint.scattered(domain).gathered(domain)
    assert back is not None
    assert_same(back, deserialize(Checkpoint, *serialize(checkpoint)))
