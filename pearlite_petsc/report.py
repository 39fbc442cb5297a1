"""Command: figures and report of an output folder, from ``results.h5`` (or the tables) alone."""

import logging
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pearlite_petsc.command_line import CommandParser, complain
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.output.draw import draw_all, figure_jobs, film_jobs
from pearlite_petsc.output.experiment import read_experiment
from pearlite_petsc.output.report.page import write_report
from pearlite_petsc.output.result_folder import read_result

_log = logging.getLogger(__name__)

_EXAMPLES = """examples:
  pearlite report runs/quickstart
  pearlite report runs/quickstart --animate .gif
  pearlite report runs/quickstart --experiment my_points.csv
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit status (0 done, 1 not writable, 2 bad input)."""
    parser = CommandParser(
        "report", "Draw the figures and write report.html of a run's output folder.", _EXAMPLES
    )
    parser.add_argument("folder", type=Path, help="output folder of pearlite run")
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
        help="also make films of the cracks that have fields (.gif, or .mp4 with ffmpeg)",
    )
    chosen = parser.parse_args(arguments)
    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    try:
        written = rebuild(chosen.folder, chosen.experiment, chosen.animate)
    except PearliteError as error:
        complain(str(error))
        return ExitStatus.BAD_INPUT
    except OSError as error:
        complain(f"the report cannot be written: {error}; the earlier files are kept")
        return ExitStatus.BROKEN
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
    result = read_result(folder)
    if experiment is not None:
        read = read_experiment(experiment, [state.name for state in result.scene.states])
        for note in read.notes:
            _log.info("%s", note)
        result = replace(result, measured=read.points)
    draw_all(figure_jobs(result))
    films = draw_all(film_jobs(result, film)) if film else []
    write_report(folder / "report.html", result, result.scene_text, result.provenance)
    return [*(folder / "figures" / f"{name}{film}" for name in films), folder / "report.html"]


if __name__ == "__main__":
    sys.exit(main())
