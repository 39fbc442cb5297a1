"""Command: check the laws of a Python file against what every law must fulfil.

``pearlite check-law my_law.py [SCENE.toml] [--set TABLE.KEY=VALUE]``
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from pearlite_petsc.command_line import CommandParser, add_set_option, complain
from pearlite_petsc.errors import SceneError
from pearlite_petsc.exit_status import ExitStatus

_EXAMPLES = """examples:
  pearlite check-law my_law.py
  pearlite check-law my_law.py --set damage.film_strength=0.3
  pearlite check-law my_law.py runs/own_steel.toml

Each claim is one line and concerns one interface or a small mesh; the whole check takes seconds.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit status: 0, 1 a claim does not hold, 2 bad input."""
    parser = CommandParser(
        "check-law",
        "Check damage, spring and cycle jump laws of your own against what every law must fulfil.",
        _EXAMPLES,
    )
    parser.add_argument("file", type=Path, metavar="LAW.py", help="Python file that defines LAWS")
    parser.add_argument(
        "scene",
        nargs="?",
        type=Path,
        metavar="SCENE",
        help="scene (TOML) whose states and constants to use; default: the source's",
    )
    add_set_option(parser)
    chosen = parser.parse_args(arguments)
    try:
        return check(chosen.file, chosen.scene, chosen.set)
    except SceneError as error:
        complain(str(error))
        return ExitStatus.BAD_INPUT


def check(file: Path, scene: Path | None = None, overrides: Sequence[str] = ()) -> int:
    """Print every claim about the laws of a file; return the exit status.

    Args:
        file: Python file with ``LAWS``.
        scene: Scene whose states and constants to use; None takes the source's.
        overrides: "table.key=value" each; a parameter of one law is used for that law alone.

    Raises:
        SceneError: The file or the scene cannot be used.
    """
    from pearlite_petsc.config import find_laws, load_scene, load_scene_text
    from pearlite_petsc.config.law_files import laws_of_file
    from pearlite_petsc.studies.law_claims.law import law_claims

    laws, own = find_laws([file]), laws_of_file(file)
    parameters = {f"{law.table}.{key.name}" for law in own for key in law.parameters}
    claims = failed = 0
    for law in own:
        mine = {f"{law.table}.{key.name}" for key in law.parameters}
        given = [
            text
            for text in overrides
            if (name := text.partition("=")[0].strip()) not in parameters or name in mine
        ]
        given.append(f"{law.table}.{law.key}={law.name}")
        read = load_scene_text("", str(file), given, laws)
        if scene is not None:
            read = load_scene(scene, given, laws)
        section = law_claims(law, read)
        sys.stdout.write(f"{section.title}\n")
        for claim in section.claims:
            mark = "pass" if claim.holds else "FAIL"
            found = f"expected {claim.expected}, found {claim.measured}"
            sys.stdout.write(f"  {mark}  {claim.statement} ({found})\n")
        sys.stdout.writelines(f"  note  {text}\n" for text in section.text)
        claims += len(section.claims)
        failed += sum(not claim.holds for claim in section.claims)
    sys.stdout.write(f"{claims} claims, {failed} do not hold: {file}\n")
    return ExitStatus.BROKEN if failed else ExitStatus.DONE


if __name__ == "__main__":
    sys.exit(main())
