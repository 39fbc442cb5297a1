"""One crack on one rank, as the studies grow it."""

from mpi4py import MPI

from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.growth.loop import CrackGrowth
from pearlite_petsc.growth.prepared import Prepared, prepare_growth
from pearlite_petsc.scene import Scene, State


def grow_alone(
    scene: Scene, state: State, delta_k: float, prepared: Prepared | None = None
) -> Outcome:
    """Grow one crack to its end.

    Args:
        scene, state: What to grow.
        delta_k: [MPa sqrt(um)].
        prepared: Mesh to grow it in; the state's first one if None.
    """
    prepared = prepared or prepare_growth(scene, state, 0)
    outcome = CrackGrowth(MPI.COMM_SELF, scene, state, delta_k, prepared).grown()
    # Only ranks other than the first know nothing of it.
    assert outcome is not None
    return outcome
