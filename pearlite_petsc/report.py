"""Command: figures and report of a result folder, from ``results.h5`` (or the tables) alone."""

import logging
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pearlite_petsc.command_line import CommandParser, complain
from pearlite_petsc.config import load_scene, load_scene_text
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.output.draw import Result, draw_all, figure_jobs, film_jobs
from pearlite_petsc.output.experiment import read_experiment
from pearlite_petsc.output.report.page import write_report
from pearlite_petsc.output.results import read_results
from pearlite_petsc.output.tables import read_fcg, read_growth, task_name

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
    points = experiment or _scene_experiment(result)
    if points is not None:
        states = [state.name for state in result.scene.states]
        experiment_read = read_experiment(points, states)
        for note in experiment_read.notes:
            _log.info("%s", note)
        result = replace(result, measured=experiment_read.points)
    draw_all(figure_jobs(result))
    films = draw_all(film_jobs(result, film)) if film else []
    write_report(folder / "report.html", result, scene_text, provenance)
    return [*(folder / "figures" / f"{name}{film}" for name in films), folder / "report.html"]


def load_result(folder: Path) -> tuple[Result, str, dict[str, Any]]:
    """Return the result of a folder, its scene's text and its provenance.

    ``results.h5`` if there, else ``fcg.csv`` with ``growth/`` and ``scene.resolved.toml``.

    Raises:
        SceneError: Neither is there, or a file cannot be read.
    """
    if (folder / "results.h5").is_file():
        stored = read_results(folder / "results.h5")
        scene = load_scene_text(stored.scene_text, folder.resolve().name)
        return Result(folder, scene, stored.outcomes), stored.scene_text, stored.provenance
    if not (folder / "fcg.csv").is_file():
        raise SceneError(f"{folder}: no results here (neither results.h5 nor fcg.csv)")
    scene = load_scene(folder / "scene.resolved.toml")
    scene = replace(scene, name=folder.resolve().name)
    outcomes = [_with_history(folder, outcome) for outcome in read_fcg(folder / "fcg.csv")]
    text = (folder / "scene.resolved.toml").read_text(encoding="utf-8")
    return Result(folder, scene, outcomes), text, {}


def _with_history(folder: Path, outcome: Outcome) -> Outcome:
    name = task_name(outcome.state, outcome.mesh_index, outcome.delta_k)
    path = folder / "growth" / f"{name}.csv"
    return replace(outcome, history=read_growth(path)) if path.is_file() else outcome


def _scene_experiment(result: Result) -> Path | None:
    name = result.scene.output.experiment
    return None if name is None else Path(name)


if __name__ == "__main__":
    sys.exit(main())
