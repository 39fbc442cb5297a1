"""The article and its preprint are cited wherever the source is."""

import pytest

from tests.docs.pages import ROOT

ARTICLE, PREPRINT = "10.3390/machines13040305", "10.20944/preprints202503.0141.v1"
PLACES = (
    "README.md",
    "CITATION.cff",
    "docs/theory.md",
    "pearlite_petsc/output/report/reproduce.py",
)


@pytest.mark.parametrize("place", PLACES)
def test_article_and_preprint_are_cited(place: str) -> None:
    text = (ROOT / place).read_text(encoding="utf-8")
    assert ARTICLE in text
    assert PREPRINT in text
