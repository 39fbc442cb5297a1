"""Tasks of a scene: every crack, one mesh of one state at one Delta-K."""

from dataclasses import dataclass

from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.tables import middle_delta_k, task_name
from pearlite_petsc.scene import Scene, State


@dataclass(frozen=True, slots=True)
class Task:
    """One crack to grow.

    Attributes:
        number: Place in ``all_tasks``.
        state: State of the steel.
        mesh_index: Number of the mesh (repetition).
        delta_k: [MPa sqrt(um)].
        microstructure: Number of (state, mesh); tasks that share it share their mesh.
    """

    number: int
    state: State
    mesh_index: int
    delta_k: float
    microstructure: int

    @property
    def name(self) -> str:
        """Stem of the task's files."""
        return task_name(self.state.name, self.mesh_index, self.delta_k)


def all_tasks(scene: Scene) -> tuple[Task, ...]:
    """Return every task of the scene by state, mesh, delta_k."""
    meshes, levels = scene.ensemble.meshes, scene.loading.delta_k
    microstructures = [(state, index) for state in scene.states for index in range(meshes)]
    return tuple(
        Task(number * len(levels) + place, state, index, delta_k, number)
        for number, (state, index) in enumerate(microstructures)
        for place, delta_k in enumerate(levels)
    )


def refuse_few_ranks(scene: Scene, ranks: int) -> None:
    """Check that a task finds the ranks that are to share it.

    Raises:
        SceneError: A run on so few ranks has no group.
    """
    if scene.ensemble.ranks_per_task > ranks:
        raise SceneError(
            f"[ensemble] ranks_per_task = {scene.ensemble.ranks_per_task} is more than the "
            f"{ranks} rank(s) of this run"
        )


def wants_fields(scene: Scene, task: Task) -> bool:
    """Return whether a task's fields are written."""
    if scene.output.fields == "first":
        return task.mesh_index == 0 and task.delta_k == middle_delta_k(scene)
    return scene.output.fields == "all"
