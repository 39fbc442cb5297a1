"""Where methods fail, and how: converged, fell back, stopped with a reason, wrong."""

import argparse
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from time import perf_counter

from pearlite_petsc.studies.benchmarks.cracks import Plan
from pearlite_petsc.studies.benchmarks.pareto import QUICK_WINDOW
from pearlite_petsc.studies.benchmarks.stability_studies import STUDIES, Effort, Point
from pearlite_petsc.studies.table import say, write_rows

WINDOW = (
    "window.width_um=110",
    "window.height_um=110",
    "window.notch_um=50",
    "loading.extension_um=20",
)
SHORT_WINDOW = (*QUICK_WINDOW, "loading.extension_um=8")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``bench stability``."""
    parser.add_argument(
        "--quick", action="store_true", help="one small crack, three values a study"
    )
    names = [study.__name__ for study in STUDIES]
    parser.add_argument("--only", action="append", choices=names, help="may be given again")


def main(args: argparse.Namespace) -> int:
    """Run the studies, write ``stability.csv`` and the figure."""
    if args.quick:
        effort = Effort(Plan(("moderate_AT",), (0,), (12.0,), SHORT_WINDOW), True)
    else:
        states = ("undeformed", "severe_AT", "moderate_TA")
        effort = Effort(Plan(states, (0,), (12.0,), WINDOW), False)
    points: list[Point] = []
    for study in STUDIES:
        if args.only and study.__name__ not in args.only:
            continue
        started = perf_counter()
        for point in study(effort):
            points.append(point)
            say(f"{point.study:32} {point.value:>8}  {point.outcome:20} {point.remark}")
        say(f"  ({perf_counter() - started:.1f} s)")
    write_rows(args.output / "stability.csv", [asdict(point) for point in points])
    draw(args.output / "stability", points)
    say(", ".join(f"{n} {name}" for name, n in Counter(p.outcome for p in points).items()))
    return 0


def draw(path: Path, points: list[Point]) -> None:
    """Draw what happens where."""
    from pearlite_petsc.output.figures.charts import draw_stability

    studies: dict[str, list[tuple[str, str, str]]] = {}
    for point in points:
        studies.setdefault(point.study, []).append((point.value, point.outcome, point.remark))
    draw_stability(path, studies)
