"""The laws of docs/extending.md act as the page says, and no file of the program is edited."""

import re
from typing import Any

import numpy as np

from pearlite_petsc.config import load_scene_text
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.fatigue.damage import damage_interfaces
from pearlite_petsc.laws import Laws
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.scene import Kind
from pearlite_petsc.studies.bodies import plain_mesh, random_points
from tests.docs.pages import ROOT

PAGE = ROOT / "docs" / "extending.md"


def laws_of_the_page(number: int) -> Laws:
    text = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)[number]
    content: dict[str, Any] = {}
    exec(compile(text, "my_law.py", "exec"), content)
    return SHIPPED.joined(content["LAWS"])


def test_the_damage_law_halves_the_strength_of_the_films_and_nothing_else() -> None:
    new = load_scene_text("", "scene", ["damage.law=soft_film"], laws_of_the_page(0))
    old = load_scene_text("", "scene", ["damage.law=objective"])
    kind = np.array([Kind.LAMELLA, Kind.PRIOR_AUSTENITE_GRAIN])
    found = []
    for scene in (new, old):
        interfaces = damage_interfaces(np.full(2, 3.0), kind, scene.damage, scene.states[0], 0.0)
        found.append(scene.damage.law.rate_constants(interfaces, scene.damage))
    assert (found[0].factor / found[1].factor).tolist() == [1.0, 2.0]
    assert np.array_equal(found[0].threshold, found[1].threshold)


def test_the_spring_law_slides_twice_as_easily_as_it_opens() -> None:
    scene = load_scene_text("", "scene", ["material.springs=sliding"], laws_of_the_page(1))
    mesh = plain_mesh(random_points(60, 10.0, 8.0, seed=5), 10.0, 8.0)
    stiffness = spring_stiffness(mesh, scene.material)
    assert (stiffness.k_t / stiffness.k_n == 0.5).all()
