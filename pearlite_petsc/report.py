"""Command: figures and report of a result folder, from ``results.h5`` (or the tables) alone."""

import json
import logging
import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pearlite_petsc.command_line import CommandParser, complain
from pearlite_petsc.config import load_scene, load_scene_text, scene_difference
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.output.draw import Result, draw_all, figure_jobs, film_jobs
from pearlite_petsc.output.experiment import (
    KEPT,
    MeasuredPoint,
    parse_experiment,
    read_experiment,
)
from pearlite_petsc.output.report.page import write_report
from pearlite_petsc.output.results import read_results
from pearlite_petsc.output.tables import delta_k_in_mpa_sqrt_m, read_fcg, read_growth, task_name
from pearlite_petsc.scene import Scene

_log = logging.getLogger(__name__)

_EXAMPLES = """examples:
  pearlite report runs/quickstart
  pearlite report runs/quickstart --animate .gif
  pearlite report runs/quickstart --experiment my_points.csv
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit status (0 done, 2 bad input)."""
    parser = CommandParser(
        "report", "Draw the figures and write report.html of a finished result folder.", _EXAMPLES
    )
    parser.add_argument("folder", type=Path, help="result folder of pearlite run")
    parser.add_argument(
        "--experiment",
        type=Path,
        metavar="FILE.csv",
        help="measured points: state, delta_k_mpa_sqrt_m, da_dn_m_per_cycle",
    )
    parser.add_argument(
        "--animate",
        nargs="?",
        const=".gif",
        choices=(".gif", ".mp4"),
        help="films of the cracks whose fields were written (.gif, or .mp4 with ffmpeg)",
    )
    chosen = parser.parse_args(arguments)
    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    try:
        written = rebuild(chosen.folder, chosen.experiment, chosen.animate)
    except PearliteError as error:
        complain(str(error))
        return ExitStatus.BAD_INPUT
    sys.stdout.write("".join(f"wrote {path}\n" for path in written))
    return ExitStatus.DONE


def rebuild(folder: Path, experiment: Path | None = None, film: str | None = None) -> list[Path]:
    """Draw all figures of a result folder and write its report.

    Args:
        folder: Result folder.
        experiment: CSV of measured points; by default the scene's.
        film: ``.gif`` or ``.mp4`` to make films as well.

    Returns:
        Films and report.

    Raises:
        SceneError: The folder holds no results, or something in it cannot be read.
    """
    result, scene_text, provenance = load_result(folder)
    if experiment is not None:
        read = read_experiment(experiment, [state.name for state in result.scene.states])
        for note in read.notes:
            _log.info("%s", note)
        result = replace(result, measured=read.points)
    draw_all(figure_jobs(result))
    films = draw_all(film_jobs(result, film)) if film else []
    write_report(folder / "report.html", result, scene_text, provenance)
    return [*(folder / "figures" / f"{name}{film}" for name in films), folder / "report.html"]


def load_result(folder: Path) -> tuple[Result, str, dict[str, Any]]:
    """Return the result of a folder, its scene's text and its provenance.

    ``results.h5`` if there, else ``fcg.csv`` with ``growth/`` and ``scene.resolved.toml``. The
    measured points are those kept with the results, else those that the scene names.

    Raises:
        SceneError: Neither is there, a file cannot be read, or the results are not of the scene
            that lies beside them.
    """
    if (folder / "results.h5").is_file():
        stored = read_results(folder / "results.h5")
        scene = load_scene_text(stored.scene_text, folder.resolve().name)
        _refuse_other_scene(folder, scene, stored.outcomes)
        _refuse_scene_beside(folder, stored.scene_text)
        points = _measured(scene, stored.experiment_text)
        result = Result(folder, scene, stored.outcomes, points)
        return result, stored.scene_text, stored.provenance
    if not (folder / "fcg.csv").is_file():
        raise SceneError(f"{folder}: no results here (neither results.h5 nor fcg.csv)")
    scene = load_scene(folder / "scene.resolved.toml")
    scene = replace(scene, name=folder.resolve().name)
    outcomes = [_with_history(folder, outcome) for outcome in read_fcg(folder / "fcg.csv")]
    _refuse_other_scene(folder, scene, outcomes)
    text = (folder / "scene.resolved.toml").read_text(encoding="utf-8")
    return Result(folder, scene, outcomes, _measured(scene, None)), text, {}


def _refuse_other_scene(folder: Path, scene: Scene, outcomes: Iterable[Outcome]) -> None:
    """Check that results, scene and provenance of a folder belong together.

    Raises:
        SceneError: They do not.
    """
    states = {state.name for state in scene.states}
    for o in outcomes:
        if o.state in states and o.delta_k in scene.loading.delta_k:
            continue
        raise SceneError(
            f"{folder}: holds a crack of {o.state} at {delta_k_in_mpa_sqrt_m(o.delta_k):g} "
            "MPa sqrt(m), which its scene does not ask for: results and scene are of two runs"
        )
    seed = _seed(folder / "provenance.json")
    if seed not in (None, scene.microstructure.seed):
        raise SceneError(
            f"{folder}: the results were made with seed {seed} (provenance.json), its scene has "
            f"{scene.microstructure.seed}: two runs wrote into this folder"
        )


def _refuse_scene_beside(folder: Path, stored: str) -> None:
    """Check that ``results.h5`` is of the scene that lies beside it.

    Raises:
        SceneError: It is not.
    """
    beside = folder / "scene.resolved.toml"
    if not beside.is_file():
        return
    try:
        lines = scene_difference(stored, beside.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise SceneError(f"{beside}: cannot be read ({error})") from None
    free = ("[output]", "[ensemble] ranks_per_task")
    other = [line for line in lines if not line.startswith(free)]
    if other:
        raise SceneError(
            f"{folder}: results.h5 is of another scene than scene.resolved.toml "
            f"({'; '.join(other[:5])}): two runs wrote into this folder"
        )


def _seed(path: Path) -> Any:
    """Return the seed of the microstructure that a ``provenance.json`` names, None without one."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))["seeds"]["microstructure"]
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _measured(scene: Scene, text: str | None) -> tuple[MeasuredPoint, ...]:
    states = [state.name for state in scene.states]
    if text is not None:
        return parse_experiment(text, KEPT, states).points
    name = scene.output.experiment
    return () if name is None else read_experiment(Path(name), states).points


def _with_history(folder: Path, outcome: Outcome) -> Outcome:
    name = task_name(outcome.state, outcome.mesh_index, outcome.delta_k)
    path = folder / "growth" / f"{name}.csv"
    return replace(outcome, history=read_growth(path)) if path.is_file() else outcome


if __name__ == "__main__":
    sys.exit(main())
