"""ParaView files of one task: ``<stem>_elements.xdmf`` and ``<stem>_interfaces.xdmf`` (+ .h5)."""

from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.outcome import GrowthState
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.output.element_fields import (
    Fan,
    element_stress,
    fan,
    mean_damage,
    point_displacement,
)
from pearlite_petsc.output.series_writer import SeriesWriter
from pearlite_petsc.scene import Kind, Scene
from pearlite_petsc.tessellation.mesh import Mesh

ELEMENT_FIELDS = {
    "points_um": ("um", "corners of the triangles, each element with its own"),
    "cells": ("1", "points of each triangle; the elements as fans of them"),
    "element": ("1", "number of the element in its mesh"),
    "colony": ("1", "number of the colony"),
    "block": ("1", "number of the block"),
    "prior_austenite_grain": ("1", "number of the prior austenite grain"),
    "lamella_angle_rad": ("rad", "direction of the lamellae from the x axis"),
    "displacement_um": ("um", "under Delta-K, of the points; 0 for loose elements"),
    "mean_damage": ("1", "mean over the interfaces of the element, by their length"),
    "stress_mpa": ("MPa", "mean stress of the element under Delta-K, 3 x 3 by rows"),
    "loose": ("1", "1 for elements that hang on no load-bearing interface"),
}
INTERFACE_FIELDS = {
    "points_um": ("um", "ends of the interfaces, each interface with its own"),
    "cells": ("1", "the two points of each interface"),
    "kind": ("1", "0 lamella, 1 cementite, 2 colony, 3 block, 4 prior_austenite_grain, 5 notch"),
    "damage": ("1", "0 intact, 1 broken; 1 for the notch"),
    "normal_stress_range_mpa": ("MPa", "range that drives the damage, 0 where broken"),
    "shear_stress_range_mpa": ("MPa", "range that drives the damage, 0 where broken"),
    "broken": ("1", "1 where broken, the notch's not"),
    "failure_cycles": ("cycle", "N at which it broke, NaN where it has not, 0 for the notch"),
}
"""Unit and description of every field."""


class FieldMarks:
    """Chooses the states of a series as the crack grows, knowing nothing of what comes.

    Due are the first state and the first one past each ``extension/(steps - 1)``, the end left
    out: the last state is written whatever it is. All ranks choose the same.

    Args:
        steps: Largest number of steps with the last state, >= 1.
        extension: Crack growth wanted [um].
    """

    def __init__(self, steps: int, extension: float) -> None:
        self._steps, self._extension = max(steps, 1), extension
        self._first_length: float | None = None
        self._mark = -1

    def due(self, crack_length: float) -> bool:
        """Return whether the state with this crack length [um] is to be kept; it counts as kept."""
        if self._first_length is None:
            self._first_length = crack_length
        share = (crack_length - self._first_length) / self._extension
        mark = int(share * (self._steps - 1))
        if not self._mark < mark < self._steps - 1:
            return False
        self._mark = mark
        return True


class FieldSeries:
    """Observer that keeps at most ``steps`` states of a growing crack as an XDMF time series.

    Those that ``FieldMarks`` finds due are written, and the last one. Who knows the crack length
    before the state can ask a ``FieldMarks`` of his own and leave out ``add`` for the others. Time
    is the number of cycles. A mesh that stays is stored once.

    Args:
        folder: Where the four files go; made if need be.
        stem: Name of the task.
        scene: Gives the extension, the window and the springs.
        steps: Largest number of steps, >= 1.
        ratio: k_t/k_n of the mesh for the springs ``matched``.
    """

    def __init__(
        self, folder: Path, stem: str, scene: Scene, steps: int, ratio: float | None = None
    ) -> None:
        self._scene, self._ratio = scene, ratio
        self._marks = FieldMarks(steps, scene.loading.extension)
        self._elements = SeriesWriter(folder / f"{stem}_elements.xdmf", ELEMENT_FIELDS)
        self._interfaces = SeriesWriter(folder / f"{stem}_interfaces.xdmf", INTERFACE_FIELDS)
        self._mesh: Mesh | None = None
        self._fan: Fan | None = None
        self._pending: GrowthState | None = None

    def __enter__(self) -> "FieldSeries":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None:
            self.close()
        else:
            self.abandon()

    def add(self, state: GrowthState) -> None:
        """Take the next state; cycles must not fall."""
        self._pending = state
        if self._marks.due(state.crack.length):
            self._write(state)
            self._pending = None

    def close(self) -> None:
        """Write the last state and finish the files."""
        if self._pending is not None:
            self._write(self._pending)
            self._pending = None
        self._elements.close()
        self._interfaces.close()

    def abandon(self) -> None:
        """Remove what was written so far."""
        self._elements.abandon()
        self._interfaces.abandon()

    def _write(self, state: GrowthState) -> None:
        mesh = state.mesh
        if self._fan is None or self._mesh is None or not _same(mesh, self._mesh):
            self._fan, self._mesh = fan(mesh), mesh
            self._write_mesh(mesh, self._fan)
        owner = self._fan.owner
        stress = self._stress(state)
        self._elements.write_step(
            state.cycles,
            {"displacement_um": single(point_displacement(mesh, self._fan, state))},
            {
                "mean_damage": single(mean_damage(mesh, state.damage)[owner]),
                "stress_mpa": single(stress[owner]),
                "loose": state.loose[owner].astype(np.int32),
            },
        )
        self._interfaces.write_step(
            state.cycles,
            {},
            {
                "damage": single(state.damage),
                "normal_stress_range_mpa": single(state.normal_stress),
                "shear_stress_range_mpa": single(state.shear_stress),
                "broken": ((state.damage >= 1.0) & (mesh.kind != Kind.NOTCH)).astype(np.int32),
                "failure_cycles": np.asarray(state.failure_cycles, dtype=np.float64),
            },
        )

    def _write_mesh(self, mesh: Mesh, shape: Fan) -> None:
        labels = {
            "element": shape.owner,
            "colony": mesh.colony[shape.owner],
            "block": mesh.block[shape.owner],
            "prior_austenite_grain": mesh.prior_austenite_grain[shape.owner],
        }
        fields: dict[str, NDArray[Any]] = {
            name: values.astype(np.int32) for name, values in labels.items()
        }
        fields["lamella_angle_rad"] = single(mesh.lamella_angle[shape.owner])
        self._elements.write_mesh(shape.points, "triangle", shape.triangles, fields)
        lines = np.arange(2 * mesh.interface_count).reshape(-1, 2)
        ends = mesh.vertices[mesh.interface_vertices].reshape(-1, 2)
        self._interfaces.write_mesh(ends, "line", lines, {"kind": mesh.kind.astype(np.int32)})

    def _stress(self, state: GrowthState) -> FloatArray:
        springs = spring_stiffness(state.mesh, self._scene.material, self._ratio)
        full = np.zeros((state.mesh.element_count, 3, 3))
        full[:, :2, :2] = element_stress(state.mesh, state, springs)
        return full.reshape(-1, 9)


def _same(mesh: Mesh, other: Mesh) -> bool:
    """Return whether two meshes are the same: states read from a checkpoint have their own each."""
    return mesh is other or all(
        np.array_equal(getattr(mesh, name), getattr(other, name))
        for name in ("nucleus", "vertices", "interface_elements")
    )


def single(values: FloatArray) -> NDArray[np.float32]:
    """Return the values in single precision, which is all that a picture shows."""
    return np.asarray(values, dtype=np.float32)
