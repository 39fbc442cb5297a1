"""Expected wall time of tasks: a first guess from the model's size, corrected as tasks finish."""

import math
from collections.abc import Sequence

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.config import estimated_elements
from pearlite_petsc.ensemble.status import Status
from pearlite_petsc.ensemble.tasks import Task
from pearlite_petsc.scene import Scene

SECONDS_A_SOLVE = 2e-3
"""Share of a solve, with its block of cycles and its part of refinements, that is always there."""

SECONDS_AN_ELEMENT = 8.5e-6
"""Share that grows with the elements.

Processor time at 1,400 to 20,000 elements, 2 and 1 um wide, graded and uniform: 10 to 210 ms a
solve, met within 30 %, but twice too long where a fine mesh is graded.
"""

SECONDS_A_MESH, SECONDS_A_PLACE, SECONDS_A_NUCLEUS = 0.05, 5e-6, 8e-6
"""Time of a microstructure with its first mesh: what is always there, for each place looked at for
a hole (the smaller side of an element squared), and for each nucleus of the uniformly fine mesh.

Processor time at 1e4 to 1e6 places and 5e3 to 4e4 nuclei: 0.06 to 10 s, met within a factor of 2.2.
"""

SOLVES_A_LENGTH = 2.7
"""Solves while the crack grows by one element, sqrt(width x length); 80 cracks: 35 to 96 in 60 um."""

PENALTY = 1.0
"""Tasks' worth of trust in the first guess against the measured times."""


def solve_seconds(elements: float) -> float:
    """Return the time of one solve with the block of cycles that follows it [s]."""
    return SECONDS_A_SOLVE + SECONDS_AN_ELEMENT * elements


def mesh_seconds(scene: Scene) -> float:
    """Return the time that the microstructure and first mesh of one repetition take [s]."""
    window, elements = scene.window, scene.elements
    area = window.width * window.height
    places = area / min(elements.width, elements.length) ** 2
    nuclei = area / (elements.width * elements.length)
    return SECONDS_A_MESH + SECONDS_A_PLACE * places + SECONDS_A_NUCLEUS * nuclei


def guessed_seconds(scene: Scene, tasks: Sequence[Task]) -> FloatArray:
    """Return what a task of this size takes on the mean, one solve below the threshold [s]; (n,)."""
    elements = estimated_elements(scene)
    size = math.sqrt(scene.elements.width * scene.elements.length)
    solves = SOLVES_A_LENGTH * scene.loading.extension / size / scene.cycle_jump.delta_d
    seconds = max(solves, 1.0) * solve_seconds(elements)
    grows = np.array([task.delta_k > task.state.delta_k_th for task in tasks])
    return np.where(grows, seconds, solve_seconds(elements))


def features(scene: Scene, tasks: Sequence[Task]) -> FloatArray:
    """Return what the time may depend on beside the guess: state and distance to the threshold.

    Args:
        scene: Gives the states.
        tasks: The tasks.

    Returns:
        One column a state, and log(delta_k / (delta_k - delta_k_th)), at most 3; (n, states + 1).
    """
    names = [state.name for state in scene.states]
    table = np.zeros((len(tasks), len(names) + 1))
    for row, task in zip(table, tasks, strict=True):
        row[names.index(task.state.name)] = 1.0
        share = 1.0 - task.state.delta_k_th / task.delta_k
        row[-1] = min(3.0, -math.log(share)) if share > 0.0 else 3.0
    return table


def expected_seconds(guess: FloatArray, table: FloatArray, measured: FloatArray) -> FloatArray:
    """Return the expected wall time of every task from the guess and what was measured so far.

    Ridge regression of log(measured / guess): one common factor that costs nothing, and the
    columns of the table that must earn their place.

    Args:
        guess: First guess [s], > 0; (n,).
        table: ``features``; (n, p).
        measured: Wall time [s], NaN where not known; (n,).
    """
    known = np.isfinite(measured) & (measured > 0.0)
    if not known.any():
        return guess
    logarithm = np.log(measured[known] / guess[known])
    common = logarithm.sum() / (known.sum() + 1e-3)
    rows = table[known]
    normal = rows.T @ rows + PENALTY * np.eye(table.shape[1])
    weights = np.linalg.solve(normal, rows.T @ (logarithm - common))
    return np.asarray(guess * np.exp(np.clip(common + table @ weights, -20.0, 20.0)))


class Forecast:
    """Expected wall times of all tasks while some finish."""

    def __init__(self, scene: Scene, tasks: Sequence[Task]) -> None:
        self._guess, self._table = guessed_seconds(scene, tasks), features(scene, tasks)

    def seconds(self, status: IntArray, values: FloatArray) -> FloatArray:
        """Return the expected wall time of every task [s], the measured one of finished ones.

        Args:
            status: ``Board.status``; (n,).
            values: ``Board.values``; (n, columns).
        """
        measured = np.where(status == Status.DONE, values[:, 0], np.nan)
        expected = expected_seconds(self._guess, self._table, measured)
        return np.where(np.isfinite(measured), measured, expected)
