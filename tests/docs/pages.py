"""Shell and Python blocks, links and tables of the documentation.

Every ``sh`` and ``python`` block has a line before it that says how it is tested:

``<!-- test: verbatim -->``         as they stand
``<!-- test: quick -->``            runs get fewer and shorter cracks
``<!-- test: slow -->``             as they stand, with ``--slow``
``<!-- test: not run; reason -->``  not here; few, each with its reason

Shell blocks of one page (README and guides: of all of them) run in order, in one folder with copies of ``runs/`` and ``meshes/``; Python blocks
of one page are one script, which runs in such a folder after the page's runs.
"""

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = (
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs").glob("*.md")),
    ROOT / "docs" / "examples" / "README.md",
    ROOT / "meshes" / "README.md",
)
READING_ORDER = tuple(
    ROOT / name
    for name in ("README.md", "docs/tutorial.md", "docs/how-to.md", "docs/troubleshooting.md")
)
"""Pages that a newcomer follows one after the other, in one folder."""

MODES = ("verbatim", "quick", "slow", "not run")

_MODE = re.compile(r"<!-- test: ([a-z ]+?)(?:; (.+))? -->")


@dataclass(frozen=True, slots=True)
class Block:
    """One block: page, line of its fence, how it is tested, the reason if not, its text."""

    page: str
    line: int
    mode: str
    reason: str
    script: str


def blocks(page: Path, language: str = "sh") -> list[Block]:
    """Return the blocks of a page in a language; one without a mode has the mode ""."""
    lines = page.read_text(encoding="utf-8").splitlines()
    found = []
    for number, line in enumerate(lines):
        if line.strip() != f"```{language}":
            continue
        end = lines.index("```", number + 1)
        mark = _MODE.fullmatch(lines[number - 1].strip()) if number else None
        mode, reason = (mark[1], mark[2] or "") if mark else ("", "")
        script = "\n".join(lines[number + 1 : end]) + "\n"
        found.append(Block(page.name, number + 1, mode, reason, script))
    return found


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as forges make them."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-") for text in headings}


def links(page: Path) -> list[str]:
    """Return the targets of a page's links and pictures."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    return re.findall(r"\]\(([^)\s]+)\)", text)


def rates(page: Path, name: str) -> list[str]:
    """Return the rows of the table below ``<!-- rates of NAME -->``."""
    after = page.read_text(encoding="utf-8").split(f"<!-- rates of {name} -->\n")[1]
    return after.split("\n\n")[0].splitlines()[2:]
