"""A finished run read back: from ``results.h5``, else from the tables beside it."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pearlite_petsc.config import (
    laws_of_results,
    load_scene,
    load_scene_text,
    scene_difference,
)
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import Outcome
from pearlite_petsc.output.experiment import (
    KEPT,
    MeasuredPoint,
    parse_experiment,
    read_experiment,
)
from pearlite_petsc.output.results import read_results
from pearlite_petsc.output.tables import delta_k_in_mpa_sqrt_m, read_fcg, read_growth, task_name
from pearlite_petsc.scene import Scene


@dataclass(frozen=True, slots=True, eq=False)
class Result:
    """What figures and report are made from.

    Attributes:
        folder: The result folder.
        scene: What was computed.
        outcomes: Every task.
        measured: User's points.
        scene_text: The scene as it was resolved (TOML).
        provenance: What ran, where and when; empty where only tables are left.
    """

    folder: Path
    scene: Scene
    outcomes: Sequence[Outcome]
    measured: Sequence[MeasuredPoint] = ()
    scene_text: str = ""
    provenance: dict[str, Any] = field(default_factory=dict)


def read_result(path: Path) -> Result:
    """Return the result of a folder or of a ``results.h5``.

    In a folder ``results.h5`` counts if it is there, else ``fcg.csv`` with ``growth/`` and
    ``scene.resolved.toml``. The measured points are those kept with the results, else those that
    the scene names.

    Raises:
        SceneError: None of them is there, a file cannot be read, or the results are not of the
            scene that lies beside them.
    """
    if path.suffix in (".h5", ".hdf5"):
        if not path.is_file():
            raise SceneError(f"{path}: no such file")
        return _stored(path.parent, path)
    if (path / "results.h5").is_file():
        result = _stored(path, path / "results.h5")
        _refuse_scene_beside(path, result.scene_text)
        return result
    if not (path / "fcg.csv").is_file():
        raise SceneError(f"{path}: no results here (neither results.h5 nor fcg.csv)")
    scene = replace(read_scene(path / "scene.resolved.toml"), name=path.resolve().name)
    outcomes = [_with_history(path, outcome) for outcome in read_fcg(path / "fcg.csv")]
    _refuse_other_scene(path, scene, outcomes)
    text = (path / "scene.resolved.toml").read_text(encoding="utf-8")
    return Result(path, scene, outcomes, _measured(scene, None), text)


def read_scene(path: Path) -> Scene:
    """Return the scene of results, also where it names laws that are not at hand.

    Args:
        path: ``scene.resolved.toml``.

    Raises:
        SceneError: It cannot be read.
    """
    try:
        laws = laws_of_results(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        # The reader of scenes says what is wrong.
        return load_scene(path)
    return load_scene(path, (), laws)


def _stored(folder: Path, file: Path) -> Result:
    stored = read_results(file)
    laws = laws_of_results(stored.scene_text)
    scene = load_scene_text(stored.scene_text, folder.resolve().name, (), laws)
    _refuse_other_scene(folder, scene, stored.outcomes)
    measured = _measured(scene, stored.experiment_text)
    return Result(folder, scene, stored.outcomes, measured, stored.scene_text, stored.provenance)


def _refuse_other_scene(folder: Path, scene: Scene, outcomes: Iterable[Outcome]) -> None:
    """Check that results, scene and provenance of a folder belong together.

    Raises:
        SceneError: They do not.
    """
    states = {state.name for state in scene.states}
    for o in outcomes:
        if o.state in states and o.delta_k in scene.loading.delta_k:
            continue
        raise SceneError(
            f"{folder}: holds a crack of {o.state} at {delta_k_in_mpa_sqrt_m(o.delta_k):g} "
            "MPa sqrt(m), which its scene does not ask for: results and scene are of two runs"
        )
    seed = _seed(folder / "provenance.json")
    if seed not in (None, scene.microstructure.seed):
        raise SceneError(
            f"{folder}: the results were made with seed {seed} (provenance.json), its scene has "
            f"{scene.microstructure.seed}: two runs wrote into this folder"
        )


def _refuse_scene_beside(folder: Path, stored: str) -> None:
    """Check that ``results.h5`` is of the scene that lies beside it.

    Raises:
        SceneError: It is not.
    """
    beside = folder / "scene.resolved.toml"
    if not beside.is_file():
        return
    try:
        lines = scene_difference(stored, beside.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise SceneError(f"{beside}: cannot be read ({error})") from None
    free = ("[output]", "[ensemble] ranks_per_task")
    other = [line for line in lines if not line.startswith(free)]
    if other:
        raise SceneError(
            f"{folder}: results.h5 is of another scene than scene.resolved.toml "
            f"({'; '.join(other[:5])}): two runs wrote into this folder"
        )


def _seed(path: Path) -> Any:
    """Return the seed of the microstructure that a ``provenance.json`` names, None without one."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))["seeds"]["microstructure"]
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _measured(scene: Scene, text: str | None) -> tuple[MeasuredPoint, ...]:
    states = [state.name for state in scene.states]
    if text is not None:
        return parse_experiment(text, KEPT, states).points
    name = scene.output.experiment
    return () if name is None else read_experiment(Path(name), states).points


def _with_history(folder: Path, outcome: Outcome) -> Outcome:
    name = task_name(outcome.state, outcome.mesh_index, outcome.delta_k)
    path = folder / "growth" / f"{name}.csv"
    return replace(outcome, history=read_growth(path)) if path.is_file() else outcome
