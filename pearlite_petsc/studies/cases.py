"""The steel and the scenes that claims are computed with."""

from dataclasses import replace
from typing import Literal

from pearlite_petsc.config import load_scene_text
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.laws import SpringLaw
from pearlite_petsc.scene import Kinds, Material, Scene, Shear, Window

_DEFAULT = load_scene_text("", "verification", ["damage.law=objective"])

STEEL = _DEFAULT.material

STATES = {state.name: state for state in _DEFAULT.states}
"""The source's five states."""

DAMAGE = _DEFAULT.damage


def steel(springs: str) -> Material:
    """Return the steel with one of the spring laws shipped, by its name."""
    return replace(STEEL, springs=SHIPPED.named(SpringLaw, springs))


def scene_of(
    window: tuple[float, float, float] = (200.0, 200.0, 80.0),
    size: tuple[float, float] = (2.0, 4.0),
    refinement: Literal["follow", "corridor", "uniform"] = "uniform",
    shear: Shear = "remesh",
    springs: str = "homogeneous",
    seed: int = 1,
    extension: float = 60.0,
    kinds: Kinds = _DEFAULT.elements.kinds,
) -> Scene:
    """Return a scene of the source's microstructure; what is not said here is the default.

    Args:
        window: Width, height and notch [um].
        size: Width and length of the elements [um].
        refinement, shear, springs: As in the scene.
        seed: Of the microstructure.
        extension: Wanted growth [um].
        kinds: Rule of the interfaces' kinds.
    """
    width, length = size
    elements = replace(
        _DEFAULT.elements,
        width=width,
        length=length,
        shear=shear,
        refinement=refinement,
        radius=max(18.0, 6.0 * width),
        kinds=kinds,
    )
    return replace(
        _DEFAULT,
        microstructure=replace(_DEFAULT.microstructure, seed=seed),
        window=Window(*window),
        elements=elements,
        material=steel(springs),
        loading=replace(_DEFAULT.loading, delta_k=(2e4,), extension=extension),
        cycle_jump=replace(_DEFAULT.cycle_jump, delta_d=0.9),
        solver=replace(_DEFAULT.solver, method="direct", relative_tolerance=1e-10),
    )
