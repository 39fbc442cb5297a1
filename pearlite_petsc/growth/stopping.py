"""When the growth of a crack ends."""

from collections.abc import Sequence

from pearlite_petsc.fatigue.crack import Point
from pearlite_petsc.fatigue.outcome import StopReason
from pearlite_petsc.scene import Scene


def reason_to_stop(
    scene: Scene, extension: float, reached: Sequence[Point], solves: int
) -> StopReason | None:
    """Return why a crack ends after a block, None while it goes on.

    Args:
        scene: Extension wanted, window, refinement, limit of solves.
        extension: Growth so far [um].
        reached: Points that the crack reached in the block [um].
        solves: Linear solves so far.
    """
    if extension >= scene.loading.extension:
        return StopReason.GROWN
    if touches_edge(scene, reached):
        return StopReason.BOUNDARY
    if has_left_corridor(scene, reached):
        return StopReason.LEFT_REFINED_ZONE
    if solves >= scene.solver.max_solves:
        return StopReason.MAX_SOLVES
    return None


def touches_edge(scene: Scene, points: Sequence[Point]) -> bool:
    """Return whether any of some points [um] lies within one element of the window's edge."""
    edge = max(scene.elements.width, scene.elements.length)
    right, top = scene.window.width - edge, scene.window.height - edge
    return any(x > right or not edge < y < top for x, y in points)


def has_left_corridor(scene: Scene, points: Sequence[Point]) -> bool:
    """Return whether any of some points [um] lies within two elements of a corridor's edge."""
    elements = scene.elements
    if elements.refinement != "corridor":
        return False
    edge = elements.corridor - 2.0 * max(elements.width, elements.length)
    return any(abs(y - 0.5 * scene.window.height) > edge for _, y in points)
