"""Command: check every claim that the program rests on and write docs/verification/report.md."""

import logging
import sys
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

from pearlite_petsc.command_line import CommandParser, add_output_option, complain
from pearlite_petsc.errors import SceneError
from pearlite_petsc.exit_status import ExitStatus
from pearlite_petsc.output.whole_file import make_folder

_EXAMPLES = """examples:
  pearlite verify
  pearlite verify --quick --output /tmp/verification
  pearlite verify --only fracture --only damage --output /tmp/verification
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit status: 0, 1 a claim does not hold, 2 bad input."""
    parser = CommandParser(
        "verify",
        "Check the claims that the program rests on; exit status 1 if one does not hold.",
        _EXAMPLES,
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--quick", action="store_true", help="use coarse meshes: half a minute")
    form.add_argument("--long", action="store_true", help="use many fine meshes: up to an hour")
    add_output_option(parser, "folder of report.md and its figures", Path("docs/verification"))
    parser.add_argument(
        "--only", action="append", metavar="NAME", help="check this section; may be repeated"
    )
    chosen = parser.parse_args(arguments)
    logging.basicConfig(level=logging.WARNING, format="%(message)s", stream=sys.stderr)
    effort = "QUICK" if chosen.quick else "LONG" if chosen.long else "NORMAL"
    return verify(effort, chosen.output, chosen.only or [])


def verify(effort: str, folder: Path, only: Sequence[str]) -> int:
    """Compute the sections, print their tables, write the report; return the exit status.

    Args:
        effort: Name of the ``Effort``.
        folder: Where report and figures go.
        only: Names of sections; all of them if empty.
    """
    # Here, so that --help starts neither MPI nor PETSc.
    from pearlite_petsc.studies.verification.claim import Effort, Section, Setting
    from pearlite_petsc.studies.verification.report import terminal_table, write_report
    from pearlite_petsc.studies.verification.suite import SECTIONS

    unknown = [name for name in only if name not in SECTIONS]
    if unknown:
        complain(f"--only {unknown[0]} is unknown; known: {', '.join(SECTIONS)}")
        return ExitStatus.BAD_INPUT
    setting = Setting(Effort[effort], folder)
    try:
        make_folder(folder)
    except SceneError as error:
        complain(str(error))
        return ExitStatus.BAD_INPUT
    sections: dict[str, Section] = {}
    for name, compute in SECTIONS.items():
        if only and name not in only:
            continue
        started = perf_counter()
        sections[name] = compute(setting)
        sys.stdout.write(terminal_table(sections[name]) + "\n")
        sys.stdout.write(f"  ({perf_counter() - started:.1f} s)\n\n")
        sys.stdout.flush()
    write_report(folder / "report.md", sections, effort.lower())
    claims = [claim for section in sections.values() for claim in section.claims]
    failed = sum(not claim.holds for claim in claims)
    left_out = [text for section in sections.values() for text in section.left_out]
    end = "".join(f"left out: {text}\n" for text in left_out)
    sys.stdout.write(f"{len(claims)} claims, {failed} do not hold: {folder / 'report.md'}\n{end}")
    return ExitStatus.BROKEN if failed else ExitStatus.DONE


if __name__ == "__main__":
    sys.exit(main())
