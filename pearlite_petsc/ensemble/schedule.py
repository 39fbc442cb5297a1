"""Which task a group takes next: longest expected first, tasks of one mesh together."""

from collections.abc import Collection

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray


def next_task(
    open_tasks: BoolArray,
    touched: BoolArray,
    microstructure: IntArray,
    expected: FloatArray,
    at_hand: Collection[int],
) -> int | None:
    """Return the task to take, None if none is open.

    The longest of the meshes at hand; else the longest of the mesh nobody works on that has most
    work; else the longest of the mesh with most work left.

    Args:
        open_tasks: Tasks that may be taken; (n,).
        touched: Tasks that somebody works on; (n,).
        microstructure: Number of each task's mesh; (n,).
        expected: Expected wall time [s]; (n,).
        at_hand: Meshes that the group still has.
    """
    if not open_tasks.any():
        return None
    weight = np.where(open_tasks, expected, 0.0)
    own = open_tasks & np.isin(microstructure, list(at_hand))
    if not own.any():
        work = np.bincount(microstructure, weight)
        has_open = np.bincount(microstructure, open_tasks) > 0
        fresh = has_open & (np.bincount(microstructure, touched) == 0)
        chosen = fresh if fresh.any() else has_open
        best = int(np.argmax(np.where(chosen, work, -1.0)))
        own = open_tasks & (microstructure == best)
    return int(np.argmax(np.where(own, expected, -1.0)))
