"""Memory of a run against the number of its meshes: what a mesh leaves behind would add up.

One state, one Delta-K, a new mesh for every crack, by the command on one rank.
"""

import argparse
import tempfile
from pathlib import Path

from pearlite_petsc.studies.benchmarks.campaign import NO_PICTURES, Run, timed_run
from pearlite_petsc.studies.table import say, write_rows

SCENE = """
[states.severe_AT]
[loading]
delta_k_mpa_sqrt_m = [15.0]
extension_um = 20.0
"""
MESHES = (10, 100, 1000)
MOST_GROWTH = 1.1
"""Bar: memory with the most meshes over that with the fewest. Meshes differ in their elements, so
that the largest of many needs more than the largest of few.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``bench memory``."""
    parser.add_argument("--quick", action="store_true", help="two and ten meshes")


def main(args: argparse.Namespace) -> int:
    """Measure and write ``memory.csv``; 1 if a crack failed or memory grows with the meshes."""
    runs = []
    for meshes in (2, 10) if args.quick else MESHES:
        runs.append(run_of(meshes))
        say(f"{meshes:5} meshes: {runs[-1].memory:6.1f} MB, {runs[-1].seconds:.0f} s")
    rows = [{"meshes": run.tasks, "failed": run.failed, "memory_mb": run.memory} for run in runs]
    write_rows(args.output / "memory.csv", rows)
    growth = runs[-1].memory / runs[0].memory
    say(f"{growth:.2f} times the memory, bar {MOST_GROWTH:g}")
    return 1 if growth > MOST_GROWTH or any(run.failed for run in runs) else 0


def run_of(meshes: int) -> Run:
    """Grow a crack in each of so many meshes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "memory.toml"
        path.write_text(SCENE, encoding="utf-8")
        return timed_run(path, [*NO_PICTURES, f"ensemble.meshes={meshes}"], 1)
