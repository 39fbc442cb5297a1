"""Links between pages, to files and to headings lead somewhere."""

from pathlib import Path

import pytest

from tests.docs.pages import PAGES, ROOT, anchors, links

MORE = (
    ROOT / "CHANGELOG.md",
    ROOT / "docs" / "benchmarks" / "README.md",
    ROOT / "docs" / "verification" / "report.md",
)


@pytest.mark.parametrize("page", (*PAGES, *MORE), ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_files_and_headings_that_exist(page: Path) -> None:
    for link in links(page):
        if "://" in link:
            continue
        name, _, heading = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        assert target.exists(), f"{page.name}: {link}"
        assert not heading or heading in anchors(target), f"{page.name}: {link}"


def test_every_page_is_reached_from_the_readme() -> None:
    readme, *pages = PAGES
    linked = {(readme.parent / link.partition("#")[0]).resolve() for link in links(readme)}
    for page in pages:
        near = {
            (other.parent / link.partition("#")[0]).resolve()
            for other in linked
            if other.suffix == ".md" and other.exists()
            for link in links(other)
        }
        assert page in linked | near, page.name
