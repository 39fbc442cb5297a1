"""Pages of the site that stand elsewhere in the repository, and links between them and docs/."""

import os
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]
PAGES = ("CHANGELOG.md", "CONTRIBUTING.md", "meshes/README.md")
_LINK = re.compile(r"(\]\()([^)\s#]+)")


def on_files(files: Files, config: Any) -> Files:
    """Add the pages from outside docs/."""
    for name in PAGES:
        files.append(File.generated(config, name, abs_src_path=str(ROOT / name)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Make links lead through the site instead of through the repository."""
    uri = page.file.src_uri
    source = ROOT / uri if uri in PAGES else ROOT / "docs" / uri

    def moved(match: re.Match[str]) -> str:
        start, link = match.groups()
        target = os.path.relpath(os.path.normpath(source.parent / link), ROOT)
        if "://" in link or not (target in PAGES or target.startswith("docs/")):
            return match[0]
        inside = target.removeprefix("docs/")
        return start + os.path.relpath(inside, os.path.dirname(uri) or ".")

    return _LINK.sub(moved, markdown)
