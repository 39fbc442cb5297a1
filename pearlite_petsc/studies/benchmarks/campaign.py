"""The cracks of a scene in one command, against the plain baseline on a sample of them.

Before that, the same cracks on one rank, for the parallel efficiency. The baseline is uniformly
fine, takes the source's blocks of 0.1 and a new hierarchy for every block. A sample of the tasks is
enough: its time a crack, with the same cracks in the program's way beside it, is carried over to
all. Either way a crack is charged with its part of a mesh that all loads of the scene share.
"""

import argparse
import csv
import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import pearlite_petsc
from pearlite_petsc.config import load_scene, scene_to_toml
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.scene import Scene
from pearlite_petsc.studies.benchmarks.cracks import (
    Comparison,
    Cracks,
    Grown,
    Key,
    Plan,
    compare,
    grow,
)
from pearlite_petsc.studies.table import say, write_rows

BASELINE = (
    "elements.refinement=uniform",
    "cycle_jump.method=euler",
    "cycle_jump.delta_d=0.1",
    "solver.method=iterative",
)
NO_PICTURES = ("output.figures=false", 'output.fields="none"')
MOST_SECONDS, LEAST_EFFICIENCY, LEAST_RATIO, MOST_SOLVES = 60.0, 0.9, 30.0, 1.5
"""Bars: all cracks on two idle cores; parallel efficiency; times faster than the baseline; solves
per broken interface."""


@dataclass(frozen=True, slots=True)
class Run:
    """One run of the command: tasks, those that failed, times, solves and broken interfaces in all.

    Attributes:
        seconds: Wall time [s].
        busy: Processor time of all ranks [s]; over the ranks it is the wall time on idle cores.
        memory: Largest memory of a rank [MB].
    """

    tasks: int
    seconds: float
    busy: float
    failed: int
    solves: int
    broken: int
    memory: float


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``bench campaign``."""
    parser.add_argument("--scene", type=Path, default=Path("runs/paper.toml"), metavar="SCENE")
    parser.add_argument("--ranks", type=int, default=2, metavar="N", help="default: 2")
    parser.add_argument(
        "--tasks", type=int, default=5, metavar="N", help="sample for the baseline (default: 5)"
    )
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")


def main(args: argparse.Namespace) -> int:
    """Run the campaign and the sample, write ``campaign.csv``; 1 if a bar was missed."""
    overrides = [*args.set, *NO_PICTURES]
    scene = load_scene(args.scene, overrides)
    run = timed_run(args.scene, overrides, args.ranks)
    say(f"{run.tasks} cracks on {args.ranks} ranks: {run.seconds:.1f} s, busy {run.busy:.1f} s")
    alone = timed_run(args.scene, overrides, 1) if args.ranks > 1 else run
    say(f"{alone.tasks} cracks on 1 rank: {alone.seconds:.1f} s, busy {alone.busy:.1f} s")
    plans = sample(scene, args.tasks)
    default = grown(plans, ())
    with new_hierarchies():
        baseline = grown(plans, BASELINE)
    found = compare(default, baseline)
    base = compare(baseline, baseline)
    ratio = base.seconds / found.seconds
    rows = table(run, alone, args.ranks, found, base)
    write_rows(args.output / "campaign.csv", rows)
    for row in rows:
        say(f"{row['measure']:56} {row['value']:10.4g} {row['unit']:10} {row['bar']}")
    missed = (
        run.failed > 0
        or run.seconds > MOST_SECONDS
        or efficiency(run, alone, args.ranks) < LEAST_EFFICIENCY
        or ratio < LEAST_RATIO
        or run.solves > MOST_SOLVES * max(run.broken, 1)
    )
    return 1 if missed else 0


def efficiency(run: Run, alone: Run, ranks: int) -> float:
    """Return how well the ranks are used: 1 where n of them take 1/n of the time of one."""
    return alone.seconds / (ranks * run.seconds)


def table(
    run: Run, alone: Run, ranks: int, found: Comparison, base: Comparison
) -> list[dict[str, str | float]]:
    """Return what was measured, with its bar."""
    ratio = base.seconds / found.seconds
    values: list[tuple[str, float, str, str]] = [
        (f"cracks on {ranks} ranks", run.tasks, "cracks", ""),
        ("failed", run.failed, "cracks", "0"),
        ("wall time of the campaign", run.seconds, "s", f"<= {MOST_SECONDS:g} on idle cores"),
        ("processor time of the campaign over the ranks", run.busy / ranks, "s", ""),
        ("wall time on 1 rank", alone.seconds, "s", ""),
        (
            "parallel efficiency",
            efficiency(run, alone, ranks),
            "",
            f">= {LEAST_EFFICIENCY:g} on idle cores",
        ),
        ("solves per broken interface", run.solves / max(run.broken, 1), "", f"<= {MOST_SOLVES:g}"),
        ("processor time a crack, sample", found.seconds, "s", ""),
        ("processor time a crack, baseline, sample", base.seconds, "s", ""),
        ("cracks in the sample", base.tasks, "cracks", ""),
        ("baseline over default, sample", ratio, "times", f">= {LEAST_RATIO:g}"),
        ("baseline, all cracks, extrapolated", run.seconds * ratio, "s", ""),
        ("sample on the baseline's path", found.same_path, "cracks", ""),
        ("da/dN over the baseline's on those, minus 1", found.bias, "", ""),
    ]
    names = ("measure", "value", "unit", "bar")
    return [dict(zip(names, row, strict=True)) for row in values]


def timed_run(path: Path, overrides: list[str], ranks: int) -> Run:
    """Run the command on a scene in a folder of its own and time it, start of Python included.

    Raises:
        RuntimeError: The run failed.
    """
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "campaign"
        settings = [word for text in overrides for word in ("--set", text)]
        python = [sys.executable, "-m", "pearlite_petsc.run", str(path)]
        command = ["mpirun", "-n", str(ranks), *python, "--output", str(output), *settings]
        started, before = perf_counter(), _children()
        done = subprocess.run(command, env=environment(), capture_output=True, text=True)
        seconds, busy = perf_counter() - started, _children() - before
        if done.returncode not in (ExitStatus.DONE, ExitStatus.SOME_FAILED):
            raise RuntimeError(f"status {done.returncode} of the run: {done.stderr[-2000:]}")
        with (output / "fcg.csv").open(newline="", encoding="utf-8") as file:
            tasks = list(csv.DictReader(file))
        broken = sum(map(_broken, (output / "growth").glob("*.csv")))
        facts = json.loads((output / "provenance.json").read_text(encoding="utf-8"))
    failed = [row for row in tasks if row["stop_reason"] == "failed"]
    for row in failed:
        say(f"failed: {row['state']} mesh {row['mesh']} at {row['delta_k_mpa_sqrt_m']}")
    solves = sum(int(row["solves"]) for row in tasks)
    memory = float(facts["largest_memory_of_a_rank_mb"])
    return Run(len(tasks), seconds, busy, len(failed), solves, broken, memory)


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def environment() -> Mapping[str, str]:
    """Return an environment in which the ranks find this package and keep to one thread."""
    root = str(Path(pearlite_petsc.__file__).parents[1])
    paths = [root, *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "OMP_NUM_THREADS": "1"}


def _broken(path: Path) -> int:
    with path.open(newline="", encoding="utf-8") as file:
        *_, last = csv.DictReader(file)
    return int(last["broken_interfaces"])


def sample(scene: Scene, tasks: int) -> list[tuple[Scene, Plan]]:
    """Return that many tasks spread over states, meshes and loads."""
    loads = [value / 1000.0 for value in scene.loading.delta_k]
    plans = []
    for number in range(tasks):
        # The step of 3 visits all loads of a list whose length it does not divide.
        state = scene.states[number % len(scene.states)].name
        mesh = number // len(scene.states) % scene.ensemble.meshes
        delta_k = loads[(3 * number + 1) % len(loads)]
        # As in the campaign, where all loads of a mesh share it.
        plans.append((scene, Plan((state,), (mesh,), (delta_k,), sharing=len(loads))))
    return plans


@contextmanager
def new_hierarchies() -> Iterator[None]:
    """Make a new hierarchy for every solve."""
    from pearlite_petsc.solver import reuse

    kept = reuse.SETUP_COST
    # No key of a scene: only the baseline asks for it.
    reuse.SETUP_COST = ((float("inf"), -1.0),)
    try:
        yield
    finally:
        reuse.SETUP_COST = kept


def grown(plans: list[tuple[Scene, Plan]], overrides: tuple[str, ...]) -> Cracks:
    """Grow the tasks one by one."""
    found: dict[Key, Grown] = {}
    for scene, plan in plans:
        found |= grow(plan, overrides, scene_to_toml(scene))
    return found
