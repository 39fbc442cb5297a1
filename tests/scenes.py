"""Scenes for tests, made by hand."""

from dataclasses import replace
from typing import Any

from pearlite_petsc.scene import (
    CycleJump,
    Damage,
    Elements,
    Ensemble,
    Loading,
    Material,
    Microstructure,
    Output,
    Scene,
    Solver,
    Window,
)
from pearlite_petsc.studies.cases import STATES


def default_scene(**changes: Any) -> Scene:
    """Return a small scene of the five states; a change is a whole part, or a dict of one part's fields."""
    scene = Scene(
        name="test",
        microstructure=Microstructure(60.0, 30.0, 15.0, 1),
        window=Window(200.0, 200.0, 80.0),
        elements=Elements(2.0, 4.0, 30.0, 0.08, 8.0, "remesh", "follow", 12.0),
        material=Material(206e3, 0.3, "homogeneous"),
        states=tuple(STATES.values()),
        damage=Damage("objective", 4.41e-9, 30.0, 0.3, 20e3, "effective", "tip", 1.0),
        loading=Loading("k_field", "K", (8e3, 12e3, 18e3, 25e3), 0.1, 60.0),
        cycle_jump=CycleJump("compliance", 1.0, 0.05),
        solver=Solver("iterative", 1e-6, 20000),
        ensemble=Ensemble(4, 1),
        output=Output("first", 40, True, None),
    )
    for name, value in changes.items():
        part = replace(getattr(scene, name), **value) if isinstance(value, dict) else value
        scene = replace(scene, **{name: part})
    return scene
