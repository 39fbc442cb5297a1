"""The run command, of which rank 1 sees other files: every "here" in an argument is "there"."""

import os
import sys

from pearlite_petsc.run import main

RANK = next(os.environ[name] for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK") if name in os.environ)

if __name__ == "__main__":
    given = sys.argv[1:]
    if RANK == "1":
        given = [argument.replace("here", "there") for argument in given]
    sys.exit(main(given))
