"""Where a task stands, as every rank sees it."""

from enum import IntEnum

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.outcome import Outcome, StopReason

COLUMNS = ("wall_s", "da_dn", "reason")
"""Measured values of a finished task: wall time [s], da/dN [um/cycle], number of its reason."""

REASONS = tuple(StopReason)
"""Reasons by their number."""


class Status(IntEnum):
    """Where a task stands."""

    OPEN = 0
    RUNNING = 1
    DONE = 2
    FAILED = 3


def status_of(outcome: Outcome) -> Status:
    """Return the status of a finished task."""
    return Status.FAILED if outcome.stop_reason is StopReason.FAILED else Status.DONE


def values_of(outcome: Outcome) -> FloatArray:
    """Return the measured values of a finished task; (columns,)."""
    return np.array([outcome.effort.wall_s, outcome.da_dn, REASONS.index(outcome.stop_reason)])
