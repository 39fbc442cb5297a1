"""Geometric means of da/dN over the meshes of a state, against those of the fine reference."""

import argparse
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context

import numpy as np

from pearlite_petsc.output.statistics import Estimate, counts, mean_with_interval
from pearlite_petsc.studies.benchmarks.cracks import (
    SAME_PATH,
    Cracks,
    Grown,
    Key,
    Plan,
    common_share,
    grow,
)
from pearlite_petsc.studies.benchmarks.pareto import QUICK_WINDOW, REFERENCE, STATES, WINDOW
from pearlite_petsc.studies.table import say, shown, write_rows

DELTA_K = 12.0
Row = dict[str, str | int | float | bool]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``bench means``."""
    parser.add_argument("--quick", action="store_true", help="three small cracks of two states")
    parser.add_argument("--meshes", type=int, default=20, metavar="N", help="a state (default: 20)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")


def main(args: argparse.Namespace) -> int:
    """Measure, write ``means.csv``; 1 if a mean lies outside the reference's interval."""
    states = STATES[1:3] if args.quick else STATES
    meshes = 3 if args.quick else args.meshes
    window = QUICK_WINDOW if args.quick else WINDOW
    plans = [
        Plan((state,), (mesh,), (DELTA_K,), window) for state in states for mesh in range(meshes)
    ]
    cracks: dict[Key, Grown] = {}
    reference: dict[Key, Grown] = {}
    # One process a core; none is forked, which MPI would not survive.
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn")) as pool:
        grown = pool.map(partial(both, overrides=tuple(args.set)), plans)
        for done, (own, exact) in enumerate(grown, 1):
            cracks |= own
            reference |= exact
            other = [
                f"{state} mesh {mesh}: {share:.2f}" for state, mesh, share in flips(own, exact)
            ]
            say(" ".join([f"{done}/{len(plans)}", *other]))
    rows = list(table(states, cracks, reference))
    for row in rows:
        say("  ".join(f"{name} {shown(value)}" for name, value in row.items()))
    write_rows(args.output / "means.csv", rows)
    return 0 if all(row["within"] for row in rows) else 1


def both(plan: Plan, overrides: Sequence[str]) -> tuple[dict[Key, Grown], dict[Key, Grown]]:
    """Grow the cracks of a plan with some settings on top of the default, and as the reference."""
    return grow(plan, overrides), grow(plan, REFERENCE)


def table(states: Sequence[str], cracks: Cracks, reference: Cracks) -> Iterator[Row]:
    """Yield a row a state: both means with their intervals, their ratio, and the flipped paths."""
    for state in states:
        keys = [key for key in reference if key[0] == state]
        flipped = flips({key: cracks[key] for key in keys}, reference)
        logs = np.array([_logs(cracks[key], reference[key]) for key in keys])
        rated = logs[np.isfinite(logs).all(axis=1)]
        own, exact = (mean_with_interval(column) for column in rated.T)
        paired = mean_with_interval(rated[:, 0] - rated[:, 1])
        yield {
            "state": state,
            "meshes": len(keys),
            "grown_in_both": len(rated),
            **_shown("default", own),
            **_shown("reference", exact),
            **_shown("ratio", paired),
            "within": bool(exact.low <= own.value <= exact.high),
            "same_path": len(keys) - len(flipped),
            "flipped": " ".join(f"{mesh} ({share:.2f})" for _, mesh, share in flipped),
        }


def flips(cracks: Cracks, reference: Cracks) -> list[tuple[str, int, float]]:
    """Return state, mesh and share of common breaks of those on another path than the reference."""
    found = []
    for key, crack in cracks.items():
        one, other = crack.outcome, reference[key].outcome
        share = common_share(one, other) if one is not None and other is not None else 0.0
        if share < SAME_PATH:
            found.append((key[0], key[1], share))
    return found


def _logs(one: Grown, other: Grown) -> tuple[float, float]:
    rates = [
        o.da_dn if o is not None and counts(o, bounds=True) else float("nan")
        for o in (one.outcome, other.outcome)
    ]
    first, second = np.log(rates)
    return float(first), float(second)


def _shown(name: str, log: Estimate) -> dict[str, float]:
    """Return a mean and the ends of its interval, as rates [um/cycle] or as their ratio."""
    values = {name: log.value, f"{name}_low": log.low, f"{name}_high": log.high}
    return {key: float(np.exp(value)) for key, value in values.items()}
