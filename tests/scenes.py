"""Scenes for tests."""

from dataclasses import replace
from typing import Any

from pearlite_petsc.config import load_scene_text
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.scene import Scene

PINNED = (
    "window.width_um=200",
    "window.height_um=200",
    "window.notch_um=80",
    "elements.radius_um=12",
    "damage.law=objective",
    "damage.failure_damage=1",
    "loading.extension_um=60",
    "cycle_jump.tolerance=0.05",
    "solver.method=iterative",
    "solver.relative_tolerance=1e-6",
    "output.field_steps=40",
)
"""What the tests' numbers rest on, whatever the defaults are."""


def default_scene(**changes: Any) -> Scene:
    """Return a small scene of the five states; a change is a whole part, or a dict of one part's fields."""
    scene = load_scene_text("", "test", PINNED)
    for name, value in changes.items():
        part = value
        if isinstance(value, dict):
            part = replace(getattr(scene, name), **_with_laws(name, value))
        scene = replace(scene, **{name: part})
    return scene


def _with_laws(table: str, values: dict[str, Any]) -> dict[str, Any]:
    """Return fields with the laws shipped in place of their names."""
    laws = {(law.table, law.key, law.name): law for law in SHIPPED.laws}
    return {key: laws.get((table, key, value), value) for key, value in values.items()}


STATES = {state.name: state for state in default_scene().states}
"""The source's five states."""
