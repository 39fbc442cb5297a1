"""The laws of docs/extending.md act as the page says, as they would if the program were edited."""

import csv
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pearlite_petsc.config import find_laws, load_scene_text
from pearlite_petsc.fatigue.damage import damage_interfaces
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.scene import Kind
from pearlite_petsc.studies.bodies import plain_mesh, random_points
from tests.docs.pages import ROOT
from tests.docs.test_commands import environment
from tests.mpi.launch import SCENE

PAGE = ROOT / "docs" / "extending.md"

PATCHES = {
    "my_law.py": (
        "pearlite_petsc/fatigue/damage.py",
        "    factor = factor * (interfaces.length / damage.reference_length) ** 1.5\n",
        "    film = interfaces.kind == Kind.PRIOR_AUSTENITE_GRAIN\n"
        "    factor = np.where(film, 2.0 * factor, factor)\n",
        "damage.law=objective",
        "damage.law=soft_film",
    ),
    "my_springs.py": (
        "pearlite_petsc/mechanics/springs.py",
        "    return Stiffness(k_n, k_n)\n",
        "    return Stiffness(k_n, 0.5 * material.youngs_modulus / interfaces.centre_distance)\n",
        "material.springs=homogeneous",
        "material.springs=sliding",
    ),
}
"""For each law of the page: file of the program, a line there, what to put before it to have that
law in place of one shipped, and how the one shipped and the one of the page are chosen.
"""


def laws_of_the_page() -> dict[str, str]:
    """Return the files that a reader of the page saves, by their names."""
    found = re.findall(r"^cat > (\w+\.py) <<'LAW'\n(.*?)^LAW$", PAGE.read_text(), re.DOTALL | re.M)
    return dict(found)


def saved(name: str, folder: Path) -> Path:
    file = folder / name
    file.write_text(laws_of_the_page()[name])
    return file


def test_the_damage_law_halves_the_strength_of_the_films_and_nothing_else(tmp_path: Path) -> None:
    laws = find_laws([saved("my_law.py", tmp_path)])
    new = load_scene_text("", "scene", ["damage.law=soft_film"], laws)
    old = load_scene_text("", "scene", ["damage.law=objective"])
    kind = np.array([Kind.LAMELLA, Kind.PRIOR_AUSTENITE_GRAIN])
    found = []
    for scene in (new, old):
        interfaces = damage_interfaces(np.full(2, 3.0), kind, scene.damage, scene.states[0], 0.0)
        found.append(scene.damage.law.rate_constants(interfaces, scene.damage))
    assert (found[0].factor / found[1].factor).tolist() == [1.0, 2.0]
    assert np.array_equal(found[0].threshold, found[1].threshold)


def test_the_spring_law_slides_twice_as_easily_as_it_opens(tmp_path: Path) -> None:
    laws = find_laws([saved("my_springs.py", tmp_path)])
    scene = load_scene_text("", "scene", ["material.springs=sliding"], laws)
    mesh = plain_mesh(random_points(60, 10.0, 8.0, seed=5), 10.0, 8.0)
    stiffness = spring_stiffness(mesh, scene.material)
    assert (stiffness.k_t / stiffness.k_n == 0.5).all()


def grown(program: Path, folder: Path, *arguments: object) -> list[dict[str, str]]:
    """Return the rows of ``fcg.csv`` of a run with the program in a folder, wall time aside."""
    settings = environment()
    settings["PYTHONPATH"] = f"{program}:{settings['PYTHONPATH']}"
    (folder / "small.toml").write_text(SCENE)
    run = [sys.executable, "-m", "pearlite_petsc.run", "small.toml", "--output", "out"]
    short = ["--overwrite", "--set", "loading.extension_um=10"]
    done = subprocess.run(
        [*run, *short, *map(str, arguments)],
        cwd=folder,
        env=settings,
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    with (folder / "out" / "fcg.csv").open(newline="") as stream:
        table = list(csv.DictReader(stream))
    for row in table:
        row.pop("wall_s")
    return table


@pytest.mark.parametrize("name", PATCHES)
def test_a_law_of_the_page_grows_the_cracks_of_a_program_edited_to_have_it(
    name: str, tmp_path: Path
) -> None:
    file, line, patch, shipped, own = PATCHES[name]
    law = saved(name, tmp_path)
    plain = grown(ROOT, tmp_path, "--set", shipped)
    found = grown(ROOT, tmp_path, "--load", law, "--set", own)
    edited = tmp_path / "edited"
    shutil.copytree(ROOT / "pearlite_petsc", edited / "pearlite_petsc")
    text = (edited / file).read_text()
    assert text.count(line) == 1
    (edited / file).write_text(text.replace(line, patch + line))
    assert found == grown(edited, tmp_path, "--set", shipped)
    assert [row["da_dn_m_per_cycle"] for row in found] != [
        row["da_dn_m_per_cycle"] for row in plain
    ]
