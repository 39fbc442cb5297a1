"""The examples in docstrings run and give what they say."""

import doctest
import importlib

import pytest

import pearlite_petsc as pp
from tests.source import MODULES, PACKAGE

WITH_EXAMPLES = [
    module for module, file in MODULES.items() if ">>> " in file.read_text(encoding="utf-8")
]
PURE = ("laws", "config", "microstructure", "tessellation", "mechanics", "fatigue")


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_the_examples_of_a_module_run(name: str) -> None:
    public = {known: getattr(pp, known) for known in pp.__all__}
    result = doctest.testmod(importlib.import_module(name), extraglobs=public)
    assert result.attempted > 0
    assert result.failed == 0


@pytest.mark.parametrize("part", PURE)
def test_every_pure_layer_has_examples(part: str) -> None:
    assert any(name.startswith(f"{PACKAGE}.{part}.") for name in WITH_EXAMPLES)
