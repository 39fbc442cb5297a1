"""The site of the documentation: it builds without a warning and shows public names alone."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import pearlite_petsc as pp
from pearlite_petsc import laws
from tests.docs.pages import PAGES, ROOT

pytest.importorskip("mkdocs")
PUBLIC = {
    "laws.html": {f"pearlite_petsc.laws.{name}" for name in laws.__all__},
    # There is a command of this name, too.
    "python.html": {
        f"pearlite_petsc.{'face.run.run' if name == 'run' else name}" for name in pp.__all__
    },
}
"""Page -> what it describes."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the site, any warning an error."""
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return folder


def test_every_page_is_in_the_site_and_in_its_navigation(site: Path) -> None:
    docs = ROOT / "docs"
    pages = [page.relative_to(docs) for page in docs.rglob("*.md")]
    pages += [
        page.relative_to(ROOT)
        for page in (*PAGES, ROOT / "CHANGELOG.md")
        if docs not in page.parents
    ]
    # index.md stands for it.
    pages.remove(Path("README.md"))
    navigation = (site / "index.html").read_text(encoding="utf-8")
    for page in pages:
        name = "index.html" if page.name == "README.md" else page.with_suffix(".html").name
        html = page.with_name(name).as_posix()
        assert (site / html).is_file(), page
        assert f'href="{html}"' in navigation or html == "index.html", page


@pytest.mark.parametrize("page", PUBLIC)
def test_public_names_are_described_and_no_others(site: Path, page: str) -> None:
    text = (site / page).read_text(encoding="utf-8")
    shown = set(re.findall(r'id="(pearlite_petsc[\w.]*)"', text))
    assert shown >= PUBLIC[page]
    for name in shown:
        assert any(name == public or name.startswith(f"{public}.") for public in PUBLIC[page])
        assert not re.search(r"\._", name)


def test_the_site_needs_no_other_host(site: Path) -> None:
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.search(r'<(script|link|img)[^>]+(src|href)="(https?:)?//', text), page
