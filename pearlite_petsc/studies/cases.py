"""The steel and the scenes that claims are computed with."""

from dataclasses import replace
from typing import Literal

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
    Shear,
    Solver,
    Springs,
    State,
    Window,
)

STEEL = Material(206e3, 0.3, "homogeneous")

STATES = {
    "undeformed": State("undeformed", 0.0, "AT", 470.0, 5000.0),
    "moderate_AT": State("moderate_AT", 2.0, "AT", 616.0, 4000.0),
    "severe_AT": State("severe_AT", 30.0, "AT", 1024.0, 2300.0),
    "moderate_TA": State("moderate_TA", 2.0, "TA", 616.0, 4000.0),
    "severe_TA": State("severe_TA", 30.0, "TA", 1024.0, 2300.0),
}
"""The source's five states."""

DAMAGE = Damage("objective", 4.41e-9, 30.0, 0.3, 20e3, "effective", "tip", 0.99)


def steel(springs: Springs) -> Material:
    """Return the steel with one of the spring laws."""
    return replace(STEEL, springs=springs)


def scene_of(
    window: tuple[float, float, float] = (200.0, 200.0, 80.0),
    size: tuple[float, float] = (2.0, 4.0),
    refinement: Literal["follow", "corridor", "uniform"] = "uniform",
    shear: Shear = "remesh",
    springs: Springs = "homogeneous",
    seed: int = 1,
    extension: float = 60.0,
) -> Scene:
    """Return a scene of the source's microstructure.

    Args:
        window: Width, height and notch [um].
        size: Width and length of the elements [um].
        refinement, shear, springs: As in the scene.
        seed: Of the microstructure.
        extension: Wanted growth [um].
    """
    return Scene(
        name="verification",
        microstructure=Microstructure(60.0, 30.0, 15.0, seed),
        window=Window(*window),
        elements=Elements(*size, 30.0, 0.08, 8.0, shear, refinement, max(18.0, 6.0 * size[0])),
        material=steel(springs),
        states=tuple(STATES.values()),
        damage=DAMAGE,
        loading=Loading("k_field", "K", (2e4,), 0.1, extension),
        cycle_jump=CycleJump("compliance", 0.9, 0.02),
        solver=Solver("direct", 1e-10, 20000),
        ensemble=Ensemble(1, 1),
        output=Output("none", 1, False, None),
    )
