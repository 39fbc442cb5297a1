"""A first look at laws from outside the program, before a run hangs on them."""

import numpy as np

from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.fatigue.damage import damage_interfaces
from pearlite_petsc.fatigue.lone_interface import LoneInterface
from pearlite_petsc.laws.damage import DamageInterfaces, RateConstants
from pearlite_petsc.laws.law import described
from pearlite_petsc.laws.springs import SpringInterfaces
from pearlite_petsc.mechanics.springs import stiffness_of
from pearlite_petsc.scene import CycleJump, Damage, Kind, Scene, State

LENGTH = np.array([0.05, 0.5, 2.0, 4.0, 8.0, 30.0])
"""Lengths of sample interfaces [um]; there is one of every kind but the notch's and one more."""

KIND = np.array([Kind.CEMENTITE, *(kind for kind in Kind if kind is not Kind.NOTCH)])


def sample_interfaces(damage: Damage, state: State) -> DamageInterfaces:
    """Return interfaces of many lengths and all kinds, at the crack and up to 100 um from it."""
    angle = np.linspace(0.0, np.pi, len(LENGTH))
    return damage_interfaces(
        LENGTH,
        KIND,
        damage,
        state,
        remote_threshold=10.0,
        midpoint=np.stack([np.linspace(80.0, 180.0, len(LENGTH)), 100.0 + 0.0 * angle], axis=1),
        normal=np.stack([np.sin(angle), np.cos(angle)], axis=1),
        crack_distance=np.array([0.0, 0.25, 1.0, 4.0, 20.0, 100.0]),
    )


def sample_springs() -> SpringInterfaces:
    """Return interfaces of many lengths and all kinds as a spring law sees them."""
    angle = np.linspace(0.0, np.pi, len(LENGTH))
    return SpringInterfaces(
        centre_distance=np.array([1.0, 1.5, 2.0, 3.0, 4.0, 16.0]),
        length=LENGTH,
        kind=KIND,
        midpoint=np.stack([np.linspace(80.0, 180.0, len(LENGTH)), 100.0 + 0.0 * angle], axis=1),
        normal=np.stack([np.sin(angle), np.cos(angle)], axis=1),
    )


def refuse_faulty_laws(scene: Scene) -> None:
    """Try the scene's laws from outside the program on a few interfaces of each state.

    Raises:
        SceneError: One fails, or returns what no interface can have.
    """
    try:
        if scene.damage.law.source is not None:
            for state in scene.states:
                interfaces = sample_interfaces(scene.damage, state)
                scene.damage.law.rate_constants(interfaces, scene.damage)
        if scene.material.springs.source is not None:
            stiffness_of(sample_springs(), scene.material, 1.0)
        if scene.cycle_jump.method.source is not None:
            _try_cycle_jump(scene.cycle_jump)
    except PearliteError as error:
        raise SceneError(str(error)) from error


def _try_cycle_jump(settings: CycleJump) -> None:
    """Run one block of one interface.

    Raises:
        PearliteError: The cycle jump fails.
    """
    constants = RateConstants(np.array([1e-12]), np.zeros(1), 0.3)
    try:
        LoneInterface(constants, 1000.0, 500.0, 0.5).blocks(settings, most=1)
    except PearliteError:
        raise
    except Exception as error:
        # In a generator, or where what it returned is used.
        text = f"{described(settings.method)} fails: {type(error).__name__}: {error}"
        raise PearliteError(text) from error
