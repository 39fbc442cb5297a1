"""Bodies with a notch half through, divided for some ranks and kept in files."""

import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.config import load_scene_text
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.mesh import Mesh

if TYPE_CHECKING:
    from pearlite_petsc.solver.subdomain import Subdomain

UPDATES = 3
"""Interfaces that break one after the other."""

DELTA_K = 12e3
STATE = "undeformed"


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """What one rank needs of a body.

    Attributes:
        subdomain: This rank's.
        tip: Of the notch [um].
        breaks: Interface that each update breaks; (u,).
    """

    subdomain: "Subdomain"
    tip: tuple[float, float]
    breaks: IntArray

    def load(self) -> FloatArray:
        """Return (F_x, F_y, M) of a K field on owned elements [uN, uN, uN um]; (owned, 3)."""
        from pearlite_petsc.mechanics.loads import element_forces, williams_mode_one

        boundary, centre = self.subdomain.boundary, self.subdomain.centre
        return element_forces(
            boundary.facet_start,
            boundary.facet_end,
            boundary.elements,
            centre[: self.subdomain.owned_count],
            williams_mode_one(DELTA_K, self.tip),
        )


def write_bodies(folder: Path, unknowns: float, ranks: tuple[int, ...]) -> int:
    """Make a uniformly fine mesh and write each rank's body; return its number of unknowns.

    Args:
        folder: Receives ``<ranks>_<rank>.pickle``.
        unknowns: About as many.
        ranks: Numbers of ranks to divide it for.
    """
    from pearlite_petsc.mechanics.springs import spring_stiffness
    from pearlite_petsc.solver.subdomain import element_ranges, subdomain_of
    from pearlite_petsc.tessellation.build import build_mesh

    elements = load_scene_text("", "bench").elements
    size = np.sqrt(unknowns / 3.0 * elements.width * elements.length)
    overrides = [f"window.{side}_um={size:.6g}" for side in ("width", "height")]
    overrides += [f"window.notch_um={0.5 * size:.6g}", "loading.extension_um=5"]
    scene = load_scene_text("", "bench", [*overrides, "elements.refinement=uniform"])
    mesh = build_mesh(scene, next(state for state in scene.states if state.name == STATE), 0)
    stiffness = spring_stiffness(mesh, scene.material)
    breaks = _ahead(mesh)
    for count in ranks:
        for rank, ends in enumerate(element_ranges(mesh.element_count, count)):
            body = Body(subdomain_of(mesh, stiffness, *ends), mesh.notch, breaks)
            with _file(folder, count, rank).open("wb") as stream:
                pickle.dump(body, stream)
    return 3 * mesh.element_count


def read_body(folder: Path, ranks: int, rank: int) -> Body:
    """Return the body that ``write_bodies`` wrote for a rank."""
    with _file(folder, ranks, rank).open("rb") as stream:
        body: Body = pickle.load(stream)
    return body


def _file(folder: Path, ranks: int, rank: int) -> Path:
    return folder / f"{ranks}_{rank}.pickle"


def _ahead(mesh: Mesh) -> IntArray:
    """Return interfaces ahead of the notch that a crack could take, one after the other."""
    gap = mesh.midpoint - mesh.notch
    level = (np.abs(mesh.normal[:, 1]) > 0.7) & (gap[:, 0] > 0.0) & (mesh.kind != Kind.NOTCH)
    cost = np.where(level, gap[:, 0] + 4.0 * np.abs(gap[:, 1]), np.inf)
    return np.argsort(cost, kind="stable")[:UPDATES]
