"""What one crack is: a scene, a state of the steel and a load range."""

from dataclasses import dataclass

from pearlite_petsc.scene import Scene, State


@dataclass(frozen=True, slots=True)
class CrackCase:
    """A crack to be grown.

    Attributes:
        scene: The scene.
        state: State of the steel.
        delta_k: Delta-K [MPa sqrt(um)].
    """

    scene: Scene
    state: State
    delta_k: float
