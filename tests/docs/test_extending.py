"""The laws that docs/extending.md adds can be added so, and act."""

import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pearlite_petsc.config import load_scene_text
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.fatigue.damage import damage_interfaces
from pearlite_petsc.scene import Kind
from tests.docs.pages import ROOT
from tests.docs.test_commands import environment

PAGE = ROOT / "docs" / "extending.md"

ASK = """
import numpy as np
from pearlite_petsc.config import load_scene_text
from pearlite_petsc.growth.prepared import prepare_growth
from pearlite_petsc.mechanics.springs import spring_stiffness
def scene(*overrides):
    return load_scene_text("", "scene", overrides)
"""

SPRINGS = """
new = scene("material.springs=sliding", "elements.width_um=8", "elements.length_um=8")
mesh = prepare_growth(new, new.states[0], 0).mesh
stiffness = spring_stiffness(mesh, new.material)
print(*np.unique(np.round(stiffness.k_t / stiffness.k_n, 12)))
"""


def patches() -> list[str]:
    return re.findall(r"```diff\n(.*?)```", PAGE.read_text(), re.DOTALL)


def apply(patch: str, folder: Path) -> int:
    """Apply a patch whose hunks have no line numbers; return the lines that it adds."""
    for part in patch.split("--- a/")[1:]:
        name, _, *lines = part.splitlines()
        before = "".join(f"{line[1:]}\n" for line in lines if line[0] in " -")
        after = "".join(f"{line[1:]}\n" for line in lines if line[0] in " +")
        file = folder / name
        text = file.read_text()
        assert text.count(before) == 1, f"{name} no longer has once:\n{before}"
        file.write_text(text.replace(before, after))
    return sum(line.startswith("+") and not line.startswith("+++") for line in patch.splitlines())


@pytest.mark.parametrize(
    ("number", "question", "answer"),
    [(0, SPRINGS, "0.5")],
    ids=["spring law"],
)
def test_a_law_of_at_most_ten_lines_works(
    number: int, question: str, answer: str, tmp_path: Path
) -> None:
    shutil.copytree(ROOT / "pearlite_petsc", tmp_path / "pearlite_petsc")
    assert apply(patches()[number], tmp_path) <= 10
    settings = environment()
    settings["PYTHONPATH"] = f"{tmp_path}:{settings['PYTHONPATH']}"
    done = subprocess.run(
        [sys.executable, "-c", ASK + question],
        cwd=tmp_path,
        env=settings,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == answer.split()


def test_the_damage_law_of_the_page_halves_the_strength_of_the_films_and_nothing_else() -> None:
    text = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)[0]
    content: dict[str, Any] = {}
    exec(compile(text, "my_law.py", "exec"), content)
    laws = SHIPPED.joined(content["LAWS"])
    new = load_scene_text("", "scene", ["damage.law=soft_film"], laws)
    old = load_scene_text("", "scene")
    kind = np.array([Kind.LAMELLA, Kind.PRIOR_AUSTENITE_GRAIN])
    found = []
    for scene in (new, old):
        interfaces = damage_interfaces(np.full(2, 3.0), kind, scene.damage, scene.states[0], 0.0)
        found.append(scene.damage.law.rate_constants(interfaces, scene.damage))
    assert (found[0].factor / found[1].factor).tolist() == [1.0, 2.0]
    assert np.array_equal(found[0].threshold, found[1].threshold)
