"""Error of da/dN against solves per broken interface, for every jump in cycles."""

import argparse
from dataclasses import asdict
from pathlib import Path

import numpy as np

from pearlite_petsc.studies.benchmarks.cracks import compare, grow
from pearlite_petsc.studies.benchmarks.pareto import plan_of
from pearlite_petsc.studies.table import say, write_rows

REFERENCE = ("cycle_jump.method=compliance", "cycle_jump.delta_d=0.02")
DEFAULT = ("compliance", 1.0)
BAR = 1.5
"""Most solves per broken interface of the default."""

STEPS = {
    "compliance": (0.1, 0.2, 0.5, 0.7, 0.9, 1.0),
    "exponential": (0.2, 0.5, 1.0),
    "euler": (0.1, 0.2, 0.5, 1.0),
    "heun": (0.2, 0.5, 1.0),
    "adaptive": (0.005, 0.02, 0.1),
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``bench jumps``."""
    parser.add_argument("--quick", action="store_true", help="two small cracks, few steps")
    parser.add_argument("--meshes", type=int, default=1, metavar="N", help="a state (default: 1)")


def main(args: argparse.Namespace) -> int:
    """Measure, write ``jumps.csv`` and the figure; 1 if the default needs too many solves."""
    plan = plan_of(args.quick, args.meshes)
    reference = grow(plan, REFERENCE)
    rows = []
    needed = float("nan")
    for method, steps in STEPS.items():
        for step in steps[-2:] if args.quick else steps:
            key = "tolerance" if method == "adaptive" else "delta_d"
            overrides = (f"cycle_jump.method={method}", f"cycle_jump.{key}={step}")
            found = compare(grow(plan, overrides), reference)
            rows.append({"method": method, "step": step, **asdict(found)})
            if (method, step) == DEFAULT:
                needed = found.solves_per_break
            say(
                f"{method:12} {step:6g}  error {found.error:8.3%}  bias {found.bias:+8.3%}  "
                f"same path {found.same_path}/{found.tasks}  "
                f"solves/break {found.solves_per_break:6.2f}"
            )
    write_rows(args.output / "jumps.csv", rows)
    draw(args.output / "jumps", rows)
    say(f"default: {needed:.2f} solves per broken interface, bar {BAR:g}")
    return 1 if needed > BAR else 0


def draw(path: Path, rows: list[dict[str, str | float]]) -> None:
    """Draw error over solves per broken interface with the front and the default marked."""
    from pearlite_petsc.output.figures.charts import Setting, draw_pareto

    settings = [
        Setting(
            f"{row['method']} {row['step']:g}",
            str(row["method"]),
            float(row["solves_per_break"]),
            float(row["error"]),
            (row["method"], row["step"]) == DEFAULT,
            float(row["low"]),
            float(row["high"]),
        )
        for row in rows
        if np.isfinite(float(row["error"]))
    ]
    label = "error of da/dN, same paths"
    draw_pareto(path, settings, "linear solves per broken interface", label)
