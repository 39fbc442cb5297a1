"""All figures of a result folder, from plain data.

Each figure is one independent job, so that a parallel program can share them out.
"""

import logging
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.ticker import AutoLocator

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.microstructure.labels import LabelMap, make_label_map
from pearlite_petsc.microstructure.shear import sheared_angle_cdf
from pearlite_petsc.output.figures.cracks import (
    PathLine,
    draw_paths,
    draw_state_path,
    show_paths,
)
from pearlite_petsc.output.figures.film import animate
from pearlite_petsc.output.figures.growth import draw_growth, draw_tortuosity
from pearlite_petsc.output.figures.microstructure import (
    draw_lamella_angles,
    draw_lamella_roses,
    draw_mesh,
    draw_microstructure,
    label_raster,
)
from pearlite_petsc.output.figures.null_model import draw_null_model
from pearlite_petsc.output.figures.rates import draw_rates
from pearlite_petsc.output.figures.style import state_label
from pearlite_petsc.output.result_folder import Result
from pearlite_petsc.output.snapshot import read_snapshots
from pearlite_petsc.output.tables import MPA_SQRT_UM, delta_k_in_mpa_sqrt_m, task_name
from pearlite_petsc.output.tables import middle_delta_k as middle_delta_k
from pearlite_petsc.scene import Scene, State

_log = logging.getLogger(__name__)

Job = tuple[str, Callable[[], object]]
"""Name of a figure (its file's stem) and what draws it."""


def figure_jobs(result: Result) -> list[Job]:
    """Return the figures of a result, the slow ones first.

    Drawn into ``figures/``: ``fcg``, ``null_model``, ``growth``, ``tortuosity``, ``paths``,
    ``path_<state>``, ``microstructure``, ``lamella_angles``, ``lamella_roses``, ``mesh``.
    """
    folder, scene, outcomes = result.folder / "figures", result.scene, result.outcomes
    names = [state.name for state in scene.states]
    jobs: list[Job] = [("microstructure", partial(_microstructure, folder, scene))]
    for state in scene.states:
        stem = f"path_{state.name}"
        if any(o.state == state.name and o.shape is not None for o in outcomes):
            jobs.append((stem, partial(_state_path, result, state)))
    if field_stems(result):
        jobs.append(("mesh", partial(_mesh, result)))
    if any(o.shape is not None for o in outcomes):
        jobs.append(("paths", partial(_paths, folder, scene, outcomes)))
    if any(o.history is not None for o in outcomes):
        jobs.append(("growth", partial(draw_growth, folder / "growth", outcomes, names)))
    jobs += [
        ("lamella_angles", partial(_angles, folder, scene)),
        ("fcg", partial(_rates, result)),
        ("tortuosity", partial(draw_tortuosity, folder / "tortuosity", outcomes, names)),
    ]
    if len(names) > 1:
        null = partial(draw_null_model, folder / "null_model", outcomes, scene.states)
        jobs.append(("null_model", null))
    return jobs


def draw_all(jobs: Sequence[Job]) -> list[str]:
    """Draw the figures; one that fails is named in the log and left out.

    Returns:
        Names of the figures drawn.
    """
    drawn = []
    for name, job in jobs:
        try:
            job()
            drawn.append(name)
        except PearliteError as error:
            _log.warning("figure %s is left out: %s", name, error)
    return drawn


def field_stems(result: Result) -> dict[str, str]:
    """Return the task of each state whose fields were written, the middle delta_k if there are more."""
    stems = {}
    for state in result.scene.states:
        own = sorted(
            (o for o in result.outcomes if o.state == state.name),
            key=lambda o: (o.mesh_index, abs(o.delta_k - middle_delta_k(result.scene))),
        )
        for o in own:
            stem = task_name(o.state, o.mesh_index, o.delta_k)
            if (result.folder / "fields" / f"{stem}_elements.xdmf").is_file():
                stems[state.name] = stem
                break
    return stems


def film_jobs(result: Result, suffix: str) -> list[Job]:
    """Return a film of each state's crack whose fields were written, into ``figures/``."""
    return [
        (f"film_{state}", partial(_film, result, state, stem, suffix))
        for state, stem in field_stems(result).items()
    ]


def _film(result: Result, state: str, stem: str, suffix: str) -> None:
    steps = read_snapshots(result.folder / "fields", stem)
    animate(steps, result.folder / "figures" / f"film_{state}{suffix}", stem)


def _label_map(scene: Scene, state: State, index: int) -> LabelMap:
    return make_label_map(scene.microstructure, scene.window, state, index)


def _microstructure(folder: Path, scene: Scene) -> None:
    rasters = {}
    for state in scene.states:
        # Shear thins the colonies by 1/gamma; a part of the window shows them as well.
        share = 1.0 / max(1.0, 0.25 * abs(state.shear_strain))
        half = 0.5 * share * min(scene.window.width, scene.window.height)
        x, y = 0.5 * scene.window.width, 0.5 * scene.window.height
        labels = _label_map(scene, state, 0)
        extent = (x - half, x + half, y - half, y + half)
        rasters[state.name] = label_raster(labels.labels, labels.lamella_angle, extent)
    draw_microstructure(folder / "microstructure", rasters)


def _angles(folder: Path, scene: Scene) -> None:
    angles, distribution = {}, {}
    for state in scene.states:
        maps = [_label_map(scene, state, index) for index in range(scene.ensemble.meshes)]
        angles[state.name] = np.concatenate([labels.lamella_angle for labels in maps])
        distribution[state.name] = partial(
            sheared_angle_cdf, shear_strain=state.shear_strain, orientation=state.orientation
        )
    draw_lamella_angles(folder / "lamella_angles", angles, distribution)
    draw_lamella_roses(folder / "lamella_roses", angles)


def _paths(folder: Path, scene: Scene, outcomes: Sequence[Outcome]) -> None:
    level = middle_delta_k(scene)
    paths = {
        state.name: [
            PathLine(f"mesh {o.mesh_index}", o.shape.path)
            for o in outcomes
            if o.state == state.name and o.delta_k == level and o.shape is not None
        ]
        for state in scene.states
    }
    window = (scene.window.width, scene.window.height)
    title = f"Crack paths at ΔK = {delta_k_in_mpa_sqrt_m(level):g} MPa√m, one line per mesh"
    draw_paths(folder / "paths", paths, window, title)


def _state_path(result: Result, state: State) -> None:
    scene, stem = result.scene, field_stems(result).get(state.name)
    own = sorted(
        (o for o in result.outcomes if o.state == state.name and o.shape is not None),
        key=lambda o: (o.mesh_index, o.delta_k),
    )
    index = own[0].mesh_index
    lines = [
        PathLine(f"ΔK = {o.delta_k / MPA_SQRT_UM:g} MPa√m", o.shape.path)
        for o in own
        if o.mesh_index == index and o.shape is not None
    ]
    last, last_delta_k = None, ""
    for o in own:
        if stem == task_name(o.state, o.mesh_index, o.delta_k) and o.mesh_index == index:
            last = read_snapshots(result.folder / "fields", stem, last_only=True)[-1]
            last_delta_k = f"ΔK = {o.delta_k / MPA_SQRT_UM:g} MPa√m"
    extent = _view(scene, lines)
    labels = _label_map(scene, state, index)
    raster = label_raster(labels.labels, labels.lamella_angle, extent, columns=300)
    notch = (float(lines[0].path[0, 0]), float(lines[0].path[0, 1]))
    path = result.folder / "figures" / f"path_{state.name}"
    draw_state_path(path, state.name, raster, lines, notch, index, last, last_delta_k)


def show_path(
    axes: Any, scene: Scene, state: State, index: int, path: FloatArray, delta_k: float
) -> None:
    """Put one crack's path in its microstructure, with the scale, into the axes.

    Args:
        axes: Where to draw.
        scene, state, index: The microstructure.
        path: Vertices [um], the notch's tip first; (p, 2), p >= 1.
        delta_k: [MPa sqrt(m)].
    """
    line = PathLine(f"ΔK = {delta_k:g} MPa√m", path)
    extent = _view(scene, [line])
    labels = _label_map(scene, state, index)
    raster = label_raster(labels.labels, labels.lamella_angle, extent, columns=300)
    content = show_paths(axes, raster, [line], (float(path[0, 0]), float(path[0, 1])))
    axes.xaxis.set_major_locator(AutoLocator())
    axes.yaxis.set_major_locator(AutoLocator())
    title = f"{state_label(state.name)}, mesh {index}\n{content}"
    axes.set(xlabel="x [µm]", ylabel="y [µm]", title=title)


def _view(scene: Scene, lines: Sequence[PathLine]) -> tuple[float, float, float, float]:
    """Return the square part of the window that holds the paths: left, right, bottom, top [um]."""
    points = np.concatenate([line.path for line in lines])
    low, high = points.min(axis=0), points.max(axis=0)
    half = 0.5 * float(max(high - low)) + 8.0
    half = min(max(half, 20.0), 0.5 * scene.window.width, 0.5 * scene.window.height)
    x = float(np.clip(0.5 * (low[0] + high[0]), half, scene.window.width - half))
    y = float(np.clip(0.5 * (low[1] + high[1]), half, scene.window.height - half))
    return x - half, x + half, y - half, y + half


def _rates(result: Result) -> None:
    scene, path = result.scene, result.folder / "figures" / "fcg"
    ratio = scene.loading.load_ratio
    draw_rates(path, result.outcomes, scene.states, result.measured, ratio)


def _mesh(result: Result) -> None:
    meshes = {}
    for state, stem in field_stems(result).items():
        last = read_snapshots(result.folder / "fields", stem, last_only=True)[-1]
        meshes[state] = (last.segments, last.kind)
    draw_mesh(result.folder / "figures" / "mesh", meshes)
