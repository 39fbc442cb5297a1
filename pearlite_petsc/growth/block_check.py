"""What a cycle jump returned, whoever wrote it, looked at before it is believed."""

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Trial


def refuse_impossible(comm: MPI.Comm, given: object, damage: FloatArray) -> None:
    """Refuse a block or trial that no law can mean. Collective.

    Args:
        comm: The group.
        given: What the cycle jump of this rank gave.
        damage: D of its interfaces at the block's start; (k,).

    Raises:
        PearliteError: It is neither, its cycles are not positive and finite, or its damage has
            another shape, is not within 0 and 1 or, in a block, falls somewhere; on all ranks.
    """
    found = comm.allgather(_wrong(given, damage))
    wrong = next(filter(None, found), None)
    if wrong is not None:
        raise PearliteError(f"cycle jump: {wrong}")


def _wrong(given: object, damage: FloatArray) -> str | None:
    if not isinstance(given, Block | Trial):
        return f"gave {type(given).__name__}, not a Block or Trial"
    what = f"the {type(given).__name__.lower()}'s"
    if not 0.0 < given.cycles < np.inf:
        return f"{what} cycles are {given.cycles:g}, not positive and finite"
    if np.shape(given.damage) != damage.shape:
        return f"{what} damage has the shape {np.shape(given.damage)}, not {damage.shape}"
    # On trial an interface may be put back a little, so that it does not break.
    least = damage if isinstance(given, Block) else np.zeros_like(damage)
    bad = np.flatnonzero(~((given.damage >= least) & (given.damage <= 1.0)))
    if len(bad):
        first = int(bad[0])
        value, low = given.damage[first], least[first]
        return f"{what} damage of interface {first} is {value:g}, not within {low:g} and 1"
    return None
