"""Command: the damage constant C that makes a finished result agree with measured growth rates."""

import math
import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from pearlite_petsc.command_line import CommandParser, complain
from pearlite_petsc.config import scene_to_toml
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.output.calibration import CONFIDENCE, Calibration, calibrate
from pearlite_petsc.output.experiment import COLUMNS, RUN_OUT, MeasuredPoint, read_experiment
from pearlite_petsc.output.result_folder import read_scene
from pearlite_petsc.output.tables import read_fcg
from pearlite_petsc.scene import Scene


def report(scene: Scene, result: Calibration) -> str:
    """Return what the command prints: ratios, points left out, C, its error, the scene's line."""
    lines = ["measured over computed da/dN (geometric mean over meshes):"]
    for point, ratio in result.ratios:
        where = f"{point.state:<16} {point.delta_k:>8g} MPa sqrt(m)"
        lines.append(f"  {where}  {point.da_dn:.3e} m/cycle  {ratio:8.3g}")
    lines += [f"point left out: {text}" for text in result.left_out]
    lines += [f"computed, left out: {text}" for text in result.ungrown]
    lines += [f"run-out: {text}" for text in result.run_outs]
    low, high = result.interval
    lines += [
        f"points used: {len(result.ratios)} of "
        f"{len(result.ratios) + len(result.left_out) + len(result.run_outs)}",
        f"load ratio of the scene: {scene.loading.load_ratio:g}; the points' must be the same",
        f"factor on C: {result.factor:.4g}",
        f"standard error of ln(factor): {_known(result.error)} "
        f"(points {_known(result.error_points)}, meshes {_known(result.error_meshes)})",
        f"{CONFIDENCE:.0%} confidence interval of the factor: {_known(low)} to {_known(high)}",
        *(f"note: {note}" for note in result.notes),
        f"old: {_scene_line(scene, scene.damage.c)}",
        "new, for the scene:",
        "[damage]",
        _scene_line(scene, float(f"{scene.damage.c * result.factor:.6g}")),
    ]
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return 0, or 2 for input that cannot be used."""
    parser = CommandParser(
        "calibrate",
        "Fit the damage constant C [um^5/N^2] of a finished run to measured growth rates.",
        "example: pearlite calibrate runs/paper --experiment rail.csv",
    )
    parser.add_argument("result", type=Path, help="output folder of pearlite run")
    parser.add_argument(
        "--experiment",
        type=Path,
        required=True,
        metavar="FILE.csv",
        help=f"measured points, columns {', '.join(COLUMNS)}, and optionally {RUN_OUT} (yes or no)",
    )
    parser.add_argument("--state", metavar="NAME", help="use the points of this state only")
    options = parser.parse_args(arguments)
    try:
        scene = read_scene(options.result / "scene.resolved.toml")
        outcomes = read_fcg(options.result / "fcg.csv")
        experiment = read_experiment(options.experiment, [state.name for state in scene.states])
        points = experiment.points
        if options.state is not None:
            points = _of_state(options.state, points, scene)
        text = report(scene, calibrate(outcomes, points))
        sys.stdout.write("".join(f"note: {note}\n" for note in experiment.notes) + text)
    except PearliteError as error:
        complain(str(error))
        return ExitStatus.BAD_INPUT
    return ExitStatus.DONE


def _of_state(
    state: str, points: Iterable[MeasuredPoint], scene: Scene
) -> tuple[MeasuredPoint, ...]:
    known = [one.name for one in scene.states]
    if state not in known:
        raise SceneError(f"--state {state}: not a state of the scene, known are {', '.join(known)}")
    return tuple(point for point in points if point.state == state)


def _scene_line(scene: Scene, c: float) -> str:
    changed = replace(scene, damage=replace(scene.damage, c=c))
    lines = scene_to_toml(changed).splitlines()
    return next(line for line in lines if line.startswith("c_um5_per_n2"))


def _known(value: float) -> str:
    return "unknown (one only)" if math.isnan(value) else f"{value:.3g}"


if __name__ == "__main__":
    sys.exit(main())
