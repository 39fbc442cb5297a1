"""Checks between the keys of a scene, and the size of the model that it asks for."""

import math
from collections.abc import Callable

from pearlite_petsc.laws.law import Law
from pearlite_petsc.scene import Elements, Scene, Window

MOST_ELEMENTS = 5_000_000
MOST_COLONIES = 5_000_000
MOST_TASKS = 1_000_000
MOST_SLENDER = 50.0

Problem = tuple[str, str, str]
"""Table, key and what is wrong with it."""


def estimated_elements(scene: Scene) -> int:
    """Return about how many elements one mesh of the scene has, from above.

    The integral of 1 / (width length s^2) over the window, with s the spacing in fine ones:
    1 in the fine zone (here along the whole width), then 1 + coarsening x distance up to coarsest.
    """
    elements, window = scene.elements, scene.window
    half = window.height / 2
    fine = min(_fine_half_height(elements, window), half)
    rest = half - fine
    graded = rest
    if elements.coarsening > 0:
        graded = min((elements.coarsest - 1) / elements.coarsening, rest)
    capped = (rest - graded) / elements.coarsest**2
    height = 2 * (fine + graded / (1 + elements.coarsening * graded) + capped)
    return math.ceil(window.width * height / (elements.width * elements.length))


def first_problem(scene: Scene) -> Problem | None:
    """Return the first thing that does not fit together, or None."""
    checks: tuple[Callable[[Scene], Problem | None], ...] = (
        _microstructure,
        _window,
        _elements,
        _room,
        _laws,
        _damage,
        _loading,
        _size,
    )
    for check in checks:
        problem = check(scene)
        if problem is not None:
            return problem
    return None


def _fine_half_height(elements: Elements, window: Window) -> float:
    match elements.refinement:
        case "uniform":
            return window.height / 2
        case "corridor":
            return elements.corridor
        case "follow":
            return elements.radius


def _microstructure(scene: Scene) -> Problem | None:
    sizes = scene.microstructure
    if sizes.block > sizes.prior_austenite_grain:
        limit = f"prior_austenite_grain_um = {sizes.prior_austenite_grain:g}"
        return "microstructure", "block_um", f"= {sizes.block:g} must be at most {limit}"
    if sizes.colony > sizes.block:
        limit = f"block_um = {sizes.block:g}"
        return "microstructure", "colony_um", f"= {sizes.colony:g} must be at most {limit}"
    return None


def _window(scene: Scene) -> Problem | None:
    window = scene.window
    if not window.notch < window.width:
        return "window", "notch_um", f"= {window.notch:g} must be below width_um = {window.width:g}"
    return None


def _room(scene: Scene) -> Problem | None:
    """Refuse what could end nowhere but at the boundary, which lies an element before the edge."""
    window, extension = scene.window, scene.loading.extension
    edge = window.width - max(scene.elements.width, scene.elements.length)
    if not window.notch + extension < edge:
        end = f"notch_um + extension_um = {window.notch + extension:g}"
        limit = f"[window] width_um = {window.width:g} less one element = {edge:g}"
        return "loading", "extension_um", f"= {extension:g} does not fit: {end}, {limit}"
    return None


def _elements(scene: Scene) -> Problem | None:
    elements, window = scene.elements, scene.window
    larger = max(elements.width, elements.length)
    if larger > MOST_SLENDER * min(elements.width, elements.length):
        text = f"= {elements.length:g} and width_um = {elements.width:g} differ by more than"
        return "elements", "length_um", f"{text} a factor of {MOST_SLENDER:g}"
    if elements.width > scene.microstructure.colony:
        limit = f"[microstructure] colony_um = {scene.microstructure.colony:g}"
        return "elements", "width_um", f"= {elements.width:g} must be at most {limit}"
    for name, size in (("width_um", window.width), ("height_um", window.height)):
        if size < 4 * larger:
            text = f"= {size:g} must be at least four elements = {4 * larger:g}"
            return "window", name, text
    for refinement, value in (("follow", elements.radius), ("corridor", elements.corridor)):
        if elements.refinement == refinement and value < 2 * larger:
            name = "radius_um" if refinement == "follow" else "corridor_um"
            text = f"= {value:g} must be at least two elements = {2 * larger:g}"
            return "elements", name, text
    return None


def _laws(scene: Scene) -> Problem | None:
    """Return what a law that the scene chooses says of the other values of its table."""
    chosen: tuple[tuple[Law, object], ...] = (
        (scene.material.springs, scene.material),
        (scene.damage.law, scene.damage),
        (scene.cycle_jump.method, scene.cycle_jump),
    )
    for law, table in chosen:
        problem = None if law.check is None else law.check(table)
        if problem is not None:
            return law.table, *problem
    return None


def _damage(scene: Scene) -> Problem | None:
    damage = scene.damage
    if damage.stress == "nominal" and not damage.failure_damage < 1:
        why = "under the nominal stress damage never reaches 1"
        text = f'= {damage.failure_damage:g} must be below 1 with stress = "nominal": {why}'
        return "damage", "failure_damage", text
    return None


def _loading(scene: Scene) -> Problem | None:
    if scene.loading.kind == "k_field" and scene.loading.control != "K":
        return "loading", "control", '= "stress" needs kind = "edge_crack"'
    return None


def _size(scene: Scene) -> Problem | None:
    elements = estimated_elements(scene)
    if elements > MOST_ELEMENTS:
        text = f"asks for about {elements:.2g} elements per mesh, at most {MOST_ELEMENTS:.0e}"
        return "elements", "width_um", f"= {scene.elements.width:g} {text}"
    # The unsheared window is a parallelogram, tessellated with what surrounds it.
    window, colony = scene.window, scene.microstructure.colony
    most_sheared = max(scene.states, key=lambda state: state.shear_strain)
    plain = window.width * window.height
    box = plain + most_sheared.shear_strain * max(window.width, window.height) ** 2
    one = math.pi / 4 * colony**2
    if box / one > MOST_COLONIES:
        text = f"asks for about {box / one:.2g} colonies before shear, at most {MOST_COLONIES:.0e}"
        if plain / one > MOST_COLONIES / 10:
            return "microstructure", "colony_um", f"= {colony:g} {text}"
        table = f"states.{most_sheared.name}"
        window_text = f"in a window of {window.width:g} x {window.height:g} um"
        return table, "shear_strain", f"= {most_sheared.shear_strain:g} {window_text} {text}"
    tasks = len(scene.states) * scene.ensemble.meshes * len(scene.loading.delta_k)
    if tasks > MOST_TASKS:
        text = f"asks for {tasks} tasks, at most {MOST_TASKS:.0e}"
        return "ensemble", "meshes", f"= {scene.ensemble.meshes} {text}"
    return None
