"""Speed against accuracy of cracks: one choice at a time round the default, some together."""

import argparse
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from pearlite_petsc.studies.benchmarks.cracks import Comparison, Cracks, Plan, compare, grow
from pearlite_petsc.studies.table import say, write_rows

STATES = ("undeformed", "moderate_AT", "severe_AT", "moderate_TA", "severe_TA")
WINDOW = (
    "window.width_um=140",
    "window.height_um=140",
    "window.notch_um=60",
    "loading.extension_um=30",
)
QUICK_WINDOW = (
    "window.width_um=80",
    "window.height_um=80",
    "window.notch_um=40",
    "loading.extension_um=10",
    "elements.width_um=3",
)
REFERENCE = (
    "elements.refinement=uniform",
    "cycle_jump.method=compliance",
    "cycle_jump.delta_d=0.05",
    "solver.relative_tolerance=1e-10",
)
DEFAULT = "default"
ALONE: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "default": {DEFAULT: ()},
    "cycle jump": {
        "compliance 1.0": ("cycle_jump.delta_d=1.0",),
        "compliance 0.7": ("cycle_jump.delta_d=0.7",),
        "compliance 0.5": ("cycle_jump.delta_d=0.5",),
        "compliance 0.2": ("cycle_jump.delta_d=0.2",),
        "exponential 1.0": ("cycle_jump.method=exponential", "cycle_jump.delta_d=1.0"),
        "exponential 0.5": ("cycle_jump.method=exponential", "cycle_jump.delta_d=0.5"),
        "euler 0.5": ("cycle_jump.method=euler", "cycle_jump.delta_d=0.5"),
        "euler 0.1": ("cycle_jump.method=euler", "cycle_jump.delta_d=0.1"),
        "heun 0.2": ("cycle_jump.method=heun", "cycle_jump.delta_d=0.2"),
        "adaptive 0.02": ("cycle_jump.method=adaptive", "cycle_jump.tolerance=0.02"),
    },
    "grading": {
        "uniform": ("elements.refinement=uniform",),
        "radius 12": ("elements.radius_um=12",),
        "radius 24": ("elements.radius_um=24",),
        "coarsening 0.04": ("elements.coarsening=0.04",),
        "coarsening 0.16": ("elements.coarsening=0.16",),
        "corridor 30": ("elements.refinement=corridor",),
    },
    "solver": {
        "GAMG": ("solver.method=iterative",),
        "direct": ("solver.method=direct",),
        "tolerance 1e-6": ("solver.relative_tolerance=1e-6",),
        "tolerance 1e-4": ("solver.relative_tolerance=1e-4",),
        "tolerance 1e-12": ("solver.relative_tolerance=1e-12",),
    },
    "springs": {
        "matched": ("material.springs=matched",),
        "raje": ("material.springs=raje",),
    },
    "element width": {
        "width 3": ("elements.width_um=3", "elements.length_um=6", "elements.radius_um=18"),
        "width 4": ("elements.width_um=4", "elements.length_um=8", "elements.radius_um=24"),
    },
    "together": {
        "radius 24, compliance 0.5": ("elements.radius_um=24", "cycle_jump.delta_d=0.5"),
        "coarsening 0.04, compliance 0.5": ("elements.coarsening=0.04", "cycle_jump.delta_d=0.5"),
        "uniform, compliance 0.5": ("elements.refinement=uniform", "cycle_jump.delta_d=0.5"),
        "uniform, direct, euler 0.1": (
            "elements.refinement=uniform",
            "solver.method=direct",
            "cycle_jump.method=euler",
            "cycle_jump.delta_d=0.1",
        ),
    },
}
CLEARLY = 0.95
"""A setting beats another one where its time and its error are at most this share of the other's."""

OFF_PATH = 0.02
"""Nor may its share of common broken interfaces be lower by more: cracks that leave the reference's
path, or end before it, have no error that counts.
"""

ROUNDS = 2
"""Times that each setting is measured; its time is the least, since a busy machine only adds."""

QUICK = {"default", "compliance 0.5", "uniform", "tolerance 1e-4"}


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """One setting: its group and name, its overrides, and how it did."""

    group: str
    name: str
    overrides: tuple[str, ...]
    comparison: Comparison

    @property
    def compares_paths(self) -> bool:
        """Whether most cracks are the reference's, so that rates compare one by one."""
        return 2 * self.comparison.same_path >= self.comparison.tasks

    @property
    def error(self) -> float:
        """Error of da/dN on the same paths, else of its geometric mean over all cracks."""
        found = self.comparison
        return found.error if self.compares_paths else found.mean_error

    def least(self, other: "Measured") -> "Measured":
        """Return the same setting with the shorter time of two measurements."""
        seconds = min(self.comparison.seconds, other.comparison.seconds)
        return replace(self, comparison=replace(self.comparison, seconds=seconds))

    def keeps_paths_of(self, default: "Measured") -> bool:
        """Whether no fewer interfaces are the reference's, but for chance, than the default's."""
        return self.comparison.common > default.comparison.common - OFF_PATH


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``bench pareto``."""
    parser.add_argument("--quick", action="store_true", help="two small cracks, few settings")
    parser.add_argument("--meshes", type=int, default=2, metavar="N", help="a state (default: 2)")


def main(args: argparse.Namespace) -> int:
    """Measure, write ``pareto.csv`` and the figure; 1 if the default is not on the front."""
    plan = plan_of(args.quick, args.meshes)
    grow(Plan(plan.states[:1], (0,), plan.delta_k, plan.overrides))  # loads the libraries
    reference = grow(plan, REFERENCE)
    exact = Measured("reference", "reference", REFERENCE, compare(reference, reference))
    say(f"{len(reference)} cracks; reference: {exact.comparison.seconds:.2f} s a crack")
    measured: dict[str, Measured] = {}
    for _ in range(ROUNDS):
        for item in measure(plan, reference, args.quick):
            measured[item.name] = item.least(measured.get(item.name, item))
            # After each, so that an interrupted run leaves what it has.
            rows = [row(other) for other in (exact, *measured.values())]
            write_rows(args.output / "pareto.csv", rows)
    settings = list(measured.values())
    draw(args.output / "pareto", settings)
    better = dominating(settings)
    if better:
        names = ", ".join(f"{m.name} ({m.comparison.seconds:.2f} s, {m.error:.2%})" for m in better)
        say(f"the default is not on the Pareto front; cheaper and more accurate: {names}")
    else:
        say("the default is on the Pareto front")
    return 1 if better else 0


def plan_of(quick: bool, meshes: int) -> Plan:
    """Return the cracks of all five states on some meshes each, or two small ones."""
    if quick:
        return Plan(STATES[1:3], (0,), (12.0,), QUICK_WINDOW)
    return Plan(STATES, tuple(range(meshes)), (12.0,), WINDOW)


def measure(plan: Plan, reference: Cracks, quick: bool) -> Iterator[Measured]:
    """Yield every setting with how its cracks compare with the reference."""
    for group, settings in ALONE.items():
        for name, overrides in settings.items():
            if quick and name not in QUICK:
                continue
            found = compare(grow(plan, overrides), reference)
            item = Measured(group, name, overrides, found)
            say(
                f"{name:32} {found.seconds:7.3f} s  error {item.error:8.3%}  bias "
                f"{found.bias:+8.3%}  same path {found.same_path}/{found.tasks}  common "
                f"{found.common:.3f}  solves/break {found.solves_per_break:.2f}"
            )
            yield item


def dominating(measured: list[Measured]) -> list[Measured]:
    """Return the settings that are clearly cheaper and more accurate than the default, paths too."""
    default = next(item for item in measured if item.name == DEFAULT)
    return [
        item
        for item in measured
        if item.comparison.seconds < CLEARLY * default.comparison.seconds
        and item.error < CLEARLY * default.error
        and item.keeps_paths_of(default)
    ]


def row(item: Measured) -> dict[str, str | int | float | bool]:
    """Return one line of the table."""
    return {
        "group": item.group,
        "name": item.name,
        "overrides": " ".join(item.overrides),
        "error_shown": 0.0 if item.group == "reference" else item.error,
        "error_is_of": "same paths" if item.compares_paths else "geometric mean",
        **asdict(item.comparison),
    }


def draw(path: Path, measured: list[Measured]) -> None:
    """Draw error over time with the Pareto front and the default marked."""
    from pearlite_petsc.output.figures.charts import Setting, draw_pareto

    default = next(item for item in measured if item.name == DEFAULT)
    settings = []
    for item in measured:
        found = item.comparison
        if not np.isfinite(item.error):
            continue
        low, high = found.low, found.high
        if not item.compares_paths:
            low, high = (max(item.error + sign * found.mean_scatter, 0.0) for sign in (-1, 1))
        settings.append(
            Setting(
                item.name,
                item.group,
                found.seconds,
                item.error,
                item.name == DEFAULT,
                low,
                high,
                item.keeps_paths_of(default),
            )
        )
    draw_pareto(path, settings, "time a crack on one core [s]", "error of da/dN")
