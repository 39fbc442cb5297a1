"""What a run would cost: printed by ``--dry-run`` and nothing else."""

from pathlib import Path

from pearlite_petsc.config import estimated_elements, method_warnings, scene_to_toml
from pearlite_petsc.ensemble.expected import guessed_seconds, mesh_seconds
from pearlite_petsc.ensemble.tasks import all_tasks
from pearlite_petsc.scene import Scene

BASE_MEGABYTES = 150.0
"""Python, numpy, PETSc, MPI and the drawing of figures, one rank [MB]."""

KILOBYTES_AN_ELEMENT = 6.0
"""Microstructure, mesh, matrix, hierarchy (measured at 20,000 elements: 4.8 to 6)."""


def dry_run_text(scene: Scene, folder: Path, ranks: int) -> str:
    """Return the resolved scene and the size, memory and time of its run.

    Args:
        scene: The scene.
        folder: Output folder.
        ranks: Processes that would share the work.
    """
    tasks = all_tasks(scene)
    elements = estimated_elements(scene)
    groups = max(1, ranks // scene.ensemble.ranks_per_task)
    seconds = guessed_seconds(scene, tasks)
    share = max(float(seconds.sum()) / groups, float(seconds.max(initial=0.0)))
    one = mesh_seconds(scene)
    meshing = one * max(1.0, len(scene.states) * scene.ensemble.meshes / groups)
    each = BASE_MEGABYTES + KILOBYTES_AN_ELEMENT * elements / scene.ensemble.ranks_per_task / 1e3
    states = len(scene.states)
    lines = [
        scene_to_toml(scene),
        f"output      {folder}",
        f"tasks       {len(tasks)} = {states} states x {scene.ensemble.meshes} meshes x "
        f"{len(scene.loading.delta_k)} Delta-K",
        f"elements    about {elements} per mesh at most ({3 * elements} unknowns)",
        f"memory      about {each * ranks:.0f} MB on {ranks} rank(s)",
        f"time        about {share + meshing:.0f} s on {ranks} rank(s), "
        f"{scene.ensemble.ranks_per_task} per task, of which {meshing:.0f} s for meshes; without figures; "
        "estimated from the cost of a solve and of a mesh on a core of 2020",
        *(f"note        {text}" for text in method_warnings(scene)),
    ]
    return "\n".join(lines)
