"""What a dry run says of the cost."""

import re
from pathlib import Path

import pytest

from pearlite_petsc.config import load_scene_text
from pearlite_petsc.ensemble.estimate import dry_run_text

ONE = ("ensemble.meshes=1", "loading.extension_um=12", "loading.delta_k_mpa_sqrt_m=[14]")
SLENDER = ("elements.width_um=0.2", "elements.length_um=10.0", "elements.radius_um=20")


@pytest.mark.parametrize("changes, least, most", [(ONE, 0, 2), ((*ONE, *SLENDER), 20, 60)])
def test_the_time_includes_the_meshes(changes: tuple[str, ...], least: int, most: int) -> None:
    """Of five microstructures; with slender elements 5 s each, which is what they take."""
    text = dry_run_text(load_scene_text("", "a.toml", changes), Path("out"), 1)
    line = text.split("\ntime ")[1].splitlines()[0]
    whole, meshes = (int(word) for word in re.findall(r"(\d+) s", line))
    assert least <= meshes <= whole <= most
