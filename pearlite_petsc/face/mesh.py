"""Meshes: microstructure, rigid elements and interfaces of one repetition of a state."""

import operator
from typing import TYPE_CHECKING, Any

import numpy as np

from pearlite_petsc import config
from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import SceneError
from pearlite_petsc.face.scene import Scene
from pearlite_petsc.face.table import Table
from pearlite_petsc.growth.prepared import Prepared, prepare_growth
from pearlite_petsc.scene import Kind

if TYPE_CHECKING:
    from matplotlib.axes import Axes

KIND_NAMES = np.array([kind.name.lower() for kind in sorted(Kind)])


class Mesh:
    """One mesh of a scene, as returned by ``build_mesh``: cracks grow on it from its notch.

    Attributes:
        scene: The scene that it was made from.
        state: Name of its state.
        index: Its number among the meshes of that state.
    """

    __slots__ = ("_prepared", "index", "scene", "state")

    def __init__(self, scene: Scene, prepared: Prepared) -> None:
        self.scene, self._prepared = scene, prepared
        self.state, self.index = prepared.mesh.state, prepared.mesh.index

    @property
    def window_um(self) -> tuple[float, float]:
        """Width and height of the window [um], whose lower left corner is (0, 0)."""
        return self._prepared.mesh.window

    @property
    def notch_um(self) -> tuple[float, float]:
        """Tip (x, y) of the notch as meshed [um]."""
        return self._prepared.mesh.notch

    @property
    def vertices_um(self) -> FloatArray:
        """Corners of the elements [um]; shape (vertices, 2), read-only."""
        return self._prepared.mesh.vertices

    @property
    def elements(self) -> Table:
        """One row per element: its nucleus ``x_um``, ``y_um``, its ``area_um2``, the numbers of its
        ``colony``, ``block`` and ``prior_austenite_grain``, ``lamella_angle_rad`` from the x axis,
        and whether it is ``fine``.
        """
        mesh = self._prepared.mesh
        return Table(
            {
                "x_um": mesh.centre[:, 0],
                "y_um": mesh.centre[:, 1],
                "area_um2": mesh.area,
                "colony": mesh.colony,
                "block": mesh.block,
                "prior_austenite_grain": mesh.prior_austenite_grain,
                "lamella_angle_rad": mesh.lamella_angle,
                "fine": mesh.fine,
            }
        )

    @property
    def interfaces(self) -> Table:
        """One row per interface: its ``kind``, its elements ``i`` and ``j``, the vertices ``start``
        and ``end``, its midpoint ``x_um``, ``y_um``, its ``length_um``, and the unit normal
        ``normal_x``, ``normal_y`` from i to j.
        """
        mesh = self._prepared.mesh
        return Table(
            {
                "kind": KIND_NAMES[mesh.kind],
                "i": mesh.interface_elements[:, 0],
                "j": mesh.interface_elements[:, 1],
                "start": mesh.interface_vertices[:, 0],
                "end": mesh.interface_vertices[:, 1],
                "x_um": mesh.midpoint[:, 0],
                "y_um": mesh.midpoint[:, 1],
                "length_um": mesh.length,
                "normal_x": mesh.normal[:, 0],
                "normal_y": mesh.normal[:, 1],
            }
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the columns of ``elements``, as ``pandas.DataFrame`` takes them."""
        return self.elements.to_dict()

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the interfaces, coloured by their kind; return the axes.

        Args:
            ax: Where to draw; a new figure's if None.
        """
        from pearlite_petsc.output.figures.microstructure import show_mesh
        from pearlite_petsc.output.figures.style import on_axes, state_label

        mesh = self._prepared.mesh
        with on_axes(ax) as axes:
            show_mesh(axes, mesh.vertices[mesh.interface_vertices], mesh.kind)
            axes.set(title=f"{state_label(self.state)}, mesh {self.index}")
        return axes

    def __repr__(self) -> str:
        mesh = self._prepared.mesh
        size = f"window {mesh.window[0]:g} x {mesh.window[1]:g} um"
        counts = f"{mesh.element_count:,} elements, {mesh.interface_count:,} interfaces"
        return f"<Mesh {self.state} {self.index}: {counts}, {size}, seed {mesh.seed}>"


def build_mesh(scene: Scene, state: str, index: int = 0) -> Mesh:
    """Make the microstructure of one repetition of a state, and its mesh.

    The mesh depends on the arguments alone; under ``mpirun`` every rank makes its own copy.

    Args:
        scene: Gives sizes, window, elements, states and seed.
        state: Name of one of the scene's states.
        index: Number of the mesh, from 0; ``run`` uses 0 to ``ensemble.meshes`` - 1.

    Raises:
        PearliteError: The scene has no such state, the index is negative, or the window cannot
            hold a mesh.

    Examples:
        >>> scene = Scene(window={"width_um": 80.0, "height_um": 80.0, "notch_um": 30.0},
        ...               loading={"extension_um": 20.0})
        >>> build_mesh(scene, "severe_AT").state
        'severe_AT'
        >>> build_mesh(scene, "severe_at")
        Traceback (most recent call last):
        pearlite_petsc.errors.SceneError: scene scene: state severe_at is unknown, did you mean severe_AT?
    """
    program = scene._program
    known = config.state_named(program, state)
    try:
        number = operator.index(index)
    except TypeError:
        raise SceneError(f"index = {index!r} is not a whole number") from None
    return Mesh(scene, prepare_growth(program, known, number))
