"""The same microstructures in elements of several sizes: whether da/dN follows the width.

Every crack is a row of widths.csv, written as soon as it has grown; a second call goes on with
what is missing. The table says p of da/dN ~ width^p, fitted mesh by mesh, the means with their
95 % intervals, and what the paths follow, counted on the label map.
"""

import argparse
import csv
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.config import load_scene_text
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.output.figures.style import drawing, legend_below, state_styles
from pearlite_petsc.output.provenance import source_state
from pearlite_petsc.output.statistics import mean_with_interval
from pearlite_petsc.scene import Scene
from pearlite_petsc.studies.benchmarks.cracks import Grown, Plan, grow
from pearlite_petsc.studies.benchmarks.pareto import STATES
from pearlite_petsc.studies.table import say, shown, write_rows

COMMON = ("loading.extension_um=40", 'output.fields="none"')
"""What all cracks of the study have beside --set."""

DELTA_K = 20.0
Row = dict[str, str]
Task = tuple[str, int, str]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``bench widths``."""
    parser.add_argument("--quick", action="store_true", help="two small cracks of one state")
    parser.add_argument("--meshes", type=int, default=40, metavar="N", help="a state (default: 40)")
    parser.add_argument(
        "--sizes",
        nargs="+",
        default=["1.5x1.5", "2x2", "3x3", "4x4"],
        metavar="WxL",
        help="width x length of the elements, um (default: 1.5x1.5 2x2 3x3 4x4)",
    )
    parser.add_argument("--states", nargs="+", default=list(STATES), choices=STATES)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")


def main(args: argparse.Namespace) -> int:
    """Grow what is missing, write ``widths.csv`` and the figure; 0."""
    sizes = ["4x4", "6x6"] if args.quick else args.sizes
    states = ["undeformed"] if args.quick else args.states
    meshes = 2 if args.quick else args.meshes
    settings = " ".join(sorted(args.set)) or "default"
    path = args.output / "widths.csv"
    rows = read_rows(path)
    known = {(row["state"], int(row["mesh"]), row["size"]) for row in of(rows, settings)}
    # Mesh by mesh, so that a study that was stopped holds all sizes of the meshes it has.
    tasks = [(state, mesh, size) for mesh in range(meshes) for state in states for size in sizes]
    left = [task for task in tasks if task not in known]
    for number, task in enumerate(left, 1):
        rows.append(row_of(task, settings, args.set))
        write_rows(path, rows)
        say(f"{number}/{len(left)} " + " ".join(rows[-1].values()))
    chosen = [row for row in of(rows, settings) if row["size"] in sizes]
    for line in summary(chosen, states, sizes):
        say(line)
    if len(sizes) > 1:
        draw(args.output / "widths", chosen, states, sizes)
    return 0


def read_rows(path: Path) -> list[Row]:
    """Return the rows that are there, none without a file."""
    if not path.is_file():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def of(rows: Sequence[Row], settings: str) -> list[Row]:
    """Return the rows of some settings."""
    return [row for row in rows if row["settings"] == settings]


def overrides_of(size: str) -> list[str]:
    """Return the settings of an element size, "2x4" for width and length [um].

    Raises:
        SceneError: No such size.
    """
    try:
        width, length = (float(number) for number in size.split("x"))
    except ValueError:
        raise SceneError(f"--sizes {size}: not of the form 2x4") from None
    return [
        f"elements.width_um={width:g}",
        f"elements.length_um={length:g}",
        f"elements.radius_um={max(18.0, 6.0 * width):g}",
    ]


def row_of(task: Task, settings: str, overrides: Sequence[str]) -> Row:
    """Grow one crack and return its row."""
    state, mesh, size = task
    every = [*COMMON, *overrides_of(size), *overrides]
    grown = grow(Plan((state,), (mesh,), (DELTA_K,)), every)[state, mesh, DELTA_K]
    commit = source_state(Path(__file__).parent)["commit"] or "unknown"
    row = {"settings": settings, "state": state, "mesh": str(mesh), "size": size}
    measured = _measured(grown, load_scene_text("", "bench", every), state, mesh)
    return row | {name: shown(value) for name, value in measured.items()} | {"commit": commit[:10]}


def _measured(
    grown: Grown, scene: Scene, state: str, mesh: int
) -> dict[str, str | int | float | bool]:
    outcome = grown.outcome
    broken = 0 if outcome is None or outcome.shape is None else len(outcome.shape.broken_pairs)
    along, through, boundary = path_shares(outcome, scene, state, mesh)
    return {
        "da_dn_um_per_cycle": float("nan") if outcome is None else outcome.da_dn,
        "extension_um": 0.0 if outcome is None else outcome.extension,
        "stop_reason": grown.error.replace(",", ";")
        if outcome is None
        else outcome.stop_reason.value,
        "solves": 0 if outcome is None else outcome.effort.solves,
        "broken": broken,
        "along_lamellae": along,
        "through_cementite": through,
        "along_boundaries": boundary,
        "seconds": grown.seconds,
    }


def path_shares(
    outcome: Outcome | None, scene: Scene, state: str, mesh: int
) -> tuple[float, float, float]:
    """Return the shares of a path along lamellae, through cementite and along boundaries.

    Counted on the label map, at four places of each interface on the path; a boundary counts
    within half an element's width of the path.
    """
    from pearlite_petsc.microstructure.labels import make_label_map
    from pearlite_petsc.tessellation.kinds import shares_along

    if outcome is None or outcome.shape is None or len(outcome.shape.path) < 2:
        return float("nan"), float("nan"), float("nan")
    chosen = next(item for item in scene.states if item.name == state)
    label_map = make_label_map(scene.microstructure, scene.window, chosen, mesh)
    step = np.diff(outcome.shape.path, axis=0)
    length = np.hypot(step[:, 0], step[:, 1])
    normal = np.stack([step[:, 1], -step[:, 0]], axis=1) / length[:, None]
    reach = np.full(len(length), 0.5 * scene.elements.width)
    shares = shares_along(label_map, outcome.shape.path[:-1], outcome.shape.path[1:], normal, reach)
    lamella, cementite, *boundaries = length @ shares / length.sum()
    return float(lamella), float(cementite), float(sum(boundaries))


def summary(rows: Sequence[Row], states: Sequence[str], sizes: Sequence[str]) -> Iterator[str]:
    """Yield what the rows say, line by line."""
    every: list[float] = []
    for state in states:
        logs, powers = common_rates(rows, state, sizes)
        if len(logs) < 2:
            continue
        means = [mean_with_interval(column) for column in logs.T.tolist()]
        ends = (
            f"{size} {np.exp(mean.value):.3g} ({np.exp(mean.low):.3g} to {np.exp(mean.high):.3g})"
            for size, mean in zip(sizes, means, strict=True)
        )
        yield f"{state}: {len(logs)} meshes, da/dN um/cycle " + ", ".join(ends)
        if len(sizes) > 1:
            every += powers.tolist()
            p = mean_with_interval(powers.tolist())
            yield f"  p = {p.value:.2f} ({p.low:.2f} to {p.high:.2f})"
        yield from _paths(rows, state, sizes)
    if every:
        p = mean_with_interval(every)
        yield f"all states: p = {p.value:.3f} ({p.low:.3f} to {p.high:.3f}), {len(every)} meshes"


def common_rates(
    rows: Sequence[Row], state: str, sizes: Sequence[str]
) -> tuple[FloatArray, FloatArray]:
    """Return log(da/dN) of the meshes that grew at all sizes, (m, s), and their p; (m,)."""
    found: defaultdict[int, dict[str, float]] = defaultdict(dict)
    for row in rows:
        rate = float(row["da_dn_um_per_cycle"])
        if row["state"] == state and rate > 0.0:
            found[int(row["mesh"])][row["size"]] = float(np.log(rate))
    whole = [[item[size] for size in sizes] for item in found.values() if len(item) == len(sizes)]
    logs = np.array(whole).reshape(-1, len(sizes))
    width = np.log([float(size.split("x")[0]) for size in sizes])
    if np.ptp(width) == 0.0:
        return logs, np.zeros(len(logs))
    return logs, logs @ (width - width.mean()) / ((width - width.mean()) ** 2).sum()


def _paths(rows: Sequence[Row], state: str, sizes: Sequence[str]) -> Iterator[str]:
    for size in sizes:
        some = [row for row in rows if (row["state"], row["size"]) == (state, size)]
        names = ("along_lamellae", "through_cementite", "along_boundaries")
        shares = [np.nanmean([float(row[name]) for row in some]) for name in names]
        ends = Counter(row["stop_reason"] for row in some)
        solves = sum(int(row["solves"]) for row in some)
        per_break = solves / max(sum(int(row["broken"]) for row in some), 1)
        paths = "/".join(f"{share:.2f}" for share in shares)
        yield (
            f"  {size}: lamellae/cementite/boundaries {paths}, {per_break:.2f} solves a break, "
            + ", ".join(f"{count} {reason}" for reason, count in sorted(ends.items()))
        )


def draw(path: Path, rows: Sequence[Row], states: Sequence[str], sizes: Sequence[str]) -> None:
    """Draw the means with their intervals over the element width."""
    with drawing(path, height=3.4) as figure:
        axes = figure.subplots()
        for name, style in state_styles(list(states)).items():
            logs, _ = common_rates(rows, name, sizes)
            if len(logs) < 2:
                continue
            means = [mean_with_interval(column) for column in logs.T.tolist()]
            y, low, high = np.exp([[mean.value, mean.low, mean.high] for mean in means]).T
            axes.errorbar(
                [float(size.split("x")[0]) for size in sizes],
                y,
                yerr=[y - low, high - y],
                color=style.colour,
                marker=style.marker,
                capsize=2.0,
                label=style.label,
            )
        axes.set(xscale="log", yscale="log", xlabel="element width [um]", ylabel="da/dN [um/cycle]")
        widths = sorted({float(size.split("x")[0]) for size in sizes})
        axes.set_xticks(widths, [f"{width:g}" for width in widths])
        axes.minorticks_off()
        legend_below(figure, axes.get_legend_handles_labels()[0], 5)
