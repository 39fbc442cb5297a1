"""All ranks: the one place that starts MPI and names its world communicator.

Commands and the Python face begin here; everything below them is given a communicator.
"""

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mpi4py import MPI


def world() -> "MPI.Comm":
    """Return the communicator of all ranks (one without ``mpirun``); the first call starts MPI."""
    # Most containers forbid copies between processes, about which Open MPI 4 then complains.
    os.environ.setdefault("OMPI_MCA_btl_vader_single_copy_mechanism", "none")
    from mpi4py import rc

    # Only the main thread calls MPI, and one-sided calls over plain networks need to know that.
    rc.thread_level = "funneled"
    from mpi4py import MPI

    return MPI.COMM_WORLD
