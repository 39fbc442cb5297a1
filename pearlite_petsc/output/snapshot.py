"""One moment of a growing crack as plain arrays, from a state or read back from its XDMF files."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import h5py
import numpy as np
from numpy.typing import NDArray

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.outcome import GrowthState
from pearlite_petsc.output.element_fields import fan, point_displacement
from pearlite_petsc.scene import Kind


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """Elements as fans of triangles, interfaces as lines.

    Attributes:
        cycles: N.
        points: Corners of the triangles [um]; (p, 2).
        triangles: (t, 3).
        displacement: Of the points, under delta_k [um]; (p, 2).
        segments: End points of the interfaces [um]; (k, 2, 2).
        damage: (k,).
        kind: Values of ``scene.Kind``; (k,).
        broken: The notch's not; (k,).
    """

    cycles: float
    points: FloatArray
    triangles: IntArray
    displacement: FloatArray
    segments: FloatArray
    damage: FloatArray
    kind: IntArray
    broken: BoolArray

    @property
    def length(self) -> float:
        """Furthest x of a broken interface or of the notch [um]."""
        cut = self.broken | (self.kind == Kind.NOTCH)
        return float(self.segments[cut][..., 0].max()) if cut.any() else 0.0


def snapshot(state: GrowthState) -> Snapshot:
    """Return the plain arrays of a state."""
    mesh = state.mesh
    shape = fan(mesh)
    return Snapshot(
        cycles=state.cycles,
        points=shape.points,
        triangles=shape.triangles,
        displacement=point_displacement(mesh, shape, state)[:, :2],
        segments=mesh.vertices[mesh.interface_vertices],
        damage=state.damage,
        kind=mesh.kind,
        broken=(state.damage >= 1.0) & (mesh.kind != Kind.NOTCH),
    )


def read_snapshots(folder: Path, stem: str, last_only: bool = False) -> list[Snapshot]:
    """Return the steps of ``<stem>_elements.xdmf`` and ``<stem>_interfaces.xdmf`` in order.

    Args:
        folder: ``fields`` of a result.
        stem: Name of the task.
        last_only: Read the last step only.

    Raises:
        SceneError: A file is missing or is not what the program writes.
    """
    try:
        elements = _steps(folder / f"{stem}_elements.xdmf", last_only)
        interfaces = _steps(folder / f"{stem}_interfaces.xdmf", last_only)
        return [
            Snapshot(
                cycles=float(lines["Time"]),
                points=solid["Geometry"][:, :2],
                triangles=solid["Topology"],
                displacement=solid["displacement"][:, :2],
                segments=lines["Geometry"][lines["Topology"]][..., :2],
                damage=lines["damage"],
                kind=lines["kind"],
                broken=lines["broken"].astype(bool),
            )
            for solid, lines in zip(elements, interfaces, strict=True)
        ]
    except (OSError, KeyError, ValueError, ElementTree.ParseError) as error:
        raise SceneError(f"{folder}: fields of {stem} cannot be read ({error})") from None


_WANTED = ("Geometry", "Topology", "displacement", "damage", "kind", "broken")


def _steps(path: Path, last_only: bool) -> list[dict[str, NDArray[Any]]]:
    grids = [
        g for g in ElementTree.parse(path).getroot().iter("Grid") if g.find("Time") is not None
    ]
    steps = []
    with h5py.File(path.with_suffix(".h5"), "r") as file:
        for grid in grids[-1:] if last_only else grids:
            step: dict[str, NDArray[Any]] = {}
            for item in grid:
                # Fields of 0.1.0 have no unit in their name.
                name = item.attrib.get("Name", item.tag).removesuffix("_um")
                if item.tag == "Time":
                    step[name] = np.array(float(item.attrib["Value"]))
                elif name in _WANTED:
                    place = (item.findtext("DataItem") or "").strip().rsplit(":/", 1)[-1]
                    step[name] = file[place][()]
            steps.append(step)
    return steps
