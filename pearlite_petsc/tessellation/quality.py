"""Measures of a mesh: sizes, spread, facet lengths, interface kinds."""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.mesh import Mesh

PERCENTILES = (0.0, 1.0, 5.0, 50.0, 95.0, 100.0)


@dataclass(frozen=True, slots=True)
class Quality:
    """Measures of a mesh; lengths and areas of the fine zone alone, kinds of the whole mesh.

    Attributes:
        elements, fine_elements, interfaces: Counts.
        equivalent_diameter: Mean equivalent circle diameter of the fine elements [um].
        area_spread: Standard deviation over mean of the fine elements' areas.
        length_percentiles: Interface lengths at `PERCENTILES` between fine elements [um].
        kind_share: Share of each kind in the number of interfaces, notch excluded.
        kind_length_share: The same, of the length.
        dropped: Facets too short to be an interface (vertices merged into another's junction).
        notch_error: Tip of the notch as meshed minus the nominal one [um].
    """

    elements: int
    fine_elements: int
    interfaces: int
    equivalent_diameter: float
    area_spread: float
    length_percentiles: tuple[float, ...]
    kind_share: dict[Kind, float]
    kind_length_share: dict[Kind, float]
    dropped: int
    notch_error: float


def quality(mesh: Mesh, notch: float) -> Quality:
    """Measure a mesh.

    Args:
        mesh: With at least one fine element.
        notch: Nominal notch [um].
    """
    area = mesh.area[mesh.fine]
    length = mesh.length[mesh.fine[mesh.interface_elements].all(axis=1)]
    inner = mesh.kind != Kind.NOTCH
    kinds = [kind for kind in Kind if kind != Kind.NOTCH]
    count = np.bincount(mesh.kind[inner], minlength=len(Kind))
    run = np.bincount(mesh.kind[inner], weights=mesh.length[inner], minlength=len(Kind))
    return Quality(
        elements=mesh.element_count,
        fine_elements=int(mesh.fine.sum()),
        interfaces=mesh.interface_count,
        equivalent_diameter=float((2.0 * np.sqrt(area / np.pi)).mean()),
        area_spread=float(area.std() / area.mean()),
        length_percentiles=tuple(float(p) for p in np.percentile(length, PERCENTILES)),
        kind_share={kind: float(count[kind] / count.sum()) for kind in kinds},
        kind_length_share={kind: float(run[kind] / run.sum()) for kind in kinds},
        dropped=len(mesh.junction) - len(np.unique(mesh.junction)),
        notch_error=mesh.notch[0] - notch,
    )
