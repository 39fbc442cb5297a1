"""The run command with a fault built in: ``faulty_run.py FAULT ARGS…``; started by the tests."""

import atexit
import importlib
import resource
import signal
import sys
from collections.abc import Iterator
from typing import Any

FAULT, *ARGUMENTS = sys.argv[1:]
STEPS_BEFORE = 3


def main() -> int:
    # PETSc must be started by the command itself, so the package is imported where it is patched.
    run = importlib.import_module("pearlite_petsc.run")

    if FAULT != "none":
        start = run._start

        def faulty(*arguments: Any) -> int:
            from pearlite_petsc.solver import initialize as petsc

            starting = petsc.initialize_petsc

            def start_and_patch(options: Any) -> None:
                petsc.initialize_petsc = starting
                starting(options)
                patch()

            petsc.initialize_petsc = start_and_patch
            return start(*arguments)

        run._start = faulty
    return run.main(ARGUMENTS)


def allow_files_of(size: int) -> None:
    """Do what the file system does when it is full, without filling one."""
    # MPI has its files by now.
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    # What measures the coverage writes its file after the run.
    atexit.register(
        resource.setrlimit, resource.RLIMIT_FSIZE, resource.getrlimit(resource.RLIMIT_FSIZE)
    )
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))


def patch() -> None:
    from pearlite_petsc.ensemble import crack, group, worker
    from pearlite_petsc.errors import MeshError, SolverError
    from pearlite_petsc.growth import refinement

    if FAULT == "small_files":
        allow_files_of(20_000)
    if FAULT == "small_figures":
        from pearlite_petsc.ensemble import session

        def draw_on_a_full_disk(*arguments: Any) -> bool:
            allow_files_of(20_000)
            return drawing(*arguments)

        drawing, session.draw_and_report = session.draw_and_report, draw_on_a_full_disk

    class Faulty(crack.CrackGrowth):
        def steps(self) -> Iterator[Any]:
            for number, step in enumerate(super().steps()):
                if number == STEPS_BEFORE and self.case.state.name == "severe_AT":
                    if FAULT == "all_ranks":
                        raise SolverError("no equilibrium, says the test")
                    if FAULT == "odd_error":
                        raise ZeroDivisionError("an error nobody thought of")
                    if FAULT == "one_rank" and self.comm.rank == 1:
                        raise ZeroDivisionError("an error on one rank only")
                yield step

    def no_mesh(scene: Any, state: Any, index: int) -> Any:
        if FAULT == "no_mesh" and state.name == "severe_AT":
            raise MeshError("no mesh, says the test")
        while FAULT == "endless_mesh" and state.name == "severe_AT":
            prepare(scene, state, index)
        return prepare(scene, state, index)

    group.AGREEMENT_SECONDS = 2.0

    def no_next_mesh(*arguments: Any) -> Any:
        raise MeshError("no finer mesh, says the test")

    def endless_figures(*arguments: Any) -> Any:
        while True:
            sum(range(1000))

    if FAULT == "endless_figures":
        from pearlite_petsc.output import draw

        draw.draw_rates = endless_figures
    if FAULT == "no_next_mesh":
        refinement.Refinement.mesh = no_next_mesh
    crack.CrackGrowth = Faulty
    prepare = worker.prepare_growth
    worker.prepare_growth = no_mesh


if __name__ == "__main__":
    sys.exit(main())
