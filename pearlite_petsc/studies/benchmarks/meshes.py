"""Meshes by the thousand, made and not grown: whether one fails, and how well the notch is met.

A row a state and width in meshes.csv, renewed every fifty meshes; a second call goes on.
"""

import argparse
import csv
from pathlib import Path
from time import process_time

from pearlite_petsc.config import load_scene_text
from pearlite_petsc.errors import MeshError
from pearlite_petsc.output.provenance import source_state
from pearlite_petsc.scene import Scene, State
from pearlite_petsc.studies.benchmarks.pareto import STATES
from pearlite_petsc.studies.table import say, write_rows

PORTION = 50
"""Meshes between two writings of the table."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``bench meshes``."""
    parser.add_argument("--quick", action="store_true", help="three meshes a state, 4 um wide")
    parser.add_argument("--meshes", type=int, default=1000, metavar="N", help="a state and width")
    parser.add_argument("--widths", type=float, nargs="+", default=[4.0, 2.0, 1.0], metavar="UM")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")


def main(args: argparse.Namespace) -> int:
    """Make the meshes, write ``meshes.csv``; 1 if one failed."""
    widths = [4.0] if args.quick else args.widths
    meshes = 3 if args.quick else args.meshes
    path = args.output / "meshes.csv"
    rows = read_rows(path)
    commit = source_state(Path(__file__).parent)["commit"] or "unknown"
    settings = " ".join(sorted(args.set)) or "default"
    for width in widths:
        for state in STATES:
            key = (settings, state, f"{width:g}")
            while (done := int(rows.get(key, {}).get("meshes", 0))) < meshes:
                count = min(PORTION, meshes - done)
                rows[key] = added(rows.get(key, {}), key, range(done, done + count), args.set)
                rows[key]["commit"] = commit[:10]
                write_rows(path, list(rows.values()))
                say(" ".join(str(value) for value in rows[key].values()))
    return 1 if any(int(row["failed"]) for row in rows.values()) else 0


def read_rows(path: Path) -> dict[tuple[str, str, str], dict[str, str]]:
    """Return the rows that are there by settings, state and width."""
    if not path.is_file():
        return {}
    with path.open(newline="", encoding="utf-8") as file:
        return {
            (row["settings"], row["state"], row["width_um"]): row for row in csv.DictReader(file)
        }


def added(
    row: dict[str, str], key: tuple[str, str, str], indices: range, overrides: list[str]
) -> dict[str, str]:
    """Return a row with more meshes in it."""
    settings, name, width = key
    size = [f"elements.{side}_um={width}" for side in ("width", "length")]
    radius = f"elements.radius_um={max(18.0, 6.0 * float(width)):g}"
    scene = load_scene_text("", "bench", [*size, radius, *overrides])
    state = next(item for item in scene.states if item.name == name)
    started = process_time()
    failed, worst = int(row.get("failed", 0)), float(row.get("notch_error_um", 0.0))
    message = row.get("first_failure", "")
    for index in indices:
        try:
            worst = max(worst, abs(notch_error(scene, state, index)))
        except MeshError as error:
            failed += 1
            message = message or f"mesh {index}: {error}".replace(",", ";")
    seconds = float(row.get("seconds", 0.0)) + process_time() - started
    return {
        "settings": settings,
        "state": name,
        "width_um": width,
        "meshes": str(indices.stop),
        "failed": str(failed),
        "notch_error_um": f"{worst:.4g}",
        "first_failure": message,
        "seconds": f"{seconds:.1f}",
    }


def notch_error(scene: Scene, state: State, index: int) -> float:
    """Return how far the tip of a mesh's notch lies from where it was asked for [um]."""
    from pearlite_petsc.tessellation.build import build_mesh

    return build_mesh(scene, state, index).notch[0] - scene.window.notch
