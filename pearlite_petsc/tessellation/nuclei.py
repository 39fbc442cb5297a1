"""Nuclei of the uniformly fine mesh: a lattice along the lamellae of each sheared colony.

Colonies of a severe state are thinner than an element, so lattices of neighbours are thinned
where they come too close and filled where they leave holes. Along the notch the nuclei below are
mirror images of those above, which makes the notch a straight run of facets.
"""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.microstructure.cells import window_cells
from pearlite_petsc.microstructure.labels import FILLING, LATTICE, PRIORITY, LabelMap, stream
from pearlite_petsc.scene import Elements, Window
from pearlite_petsc.tessellation.lattice import HOLE, Metric, lattice

NOTCH_GAP = 0.3
"""Least distance of a nucleus from the notch line, in element widths."""

NOTCH_BAND = 3.0
"""Half height of the band of mirrored nuclei along the notch, in lengths of elements (widths, where
those are larger).
"""


@dataclass(frozen=True, slots=True, eq=False)
class Nuclei:
    """Nuclei of a window.

    Attributes:
        points: [um]; (n, 2).
        partner: The mirror image across the notch line, -1 for none; (n,).
        priority: Fixed random number of each, smaller is kept first; (n,).
    """

    points: FloatArray
    partner: IntArray
    priority: FloatArray


def fine_nuclei(
    label_map: LabelMap, elements: Elements, window: Window, seed: int, index: int
) -> Nuclei:
    """Return the nuclei of the uniformly fine mesh; grading only ever takes from them.

    Args:
        label_map: Microstructure.
        elements: Width and length of the elements [um].
        window: Size and notch [um].
        seed: Of the microstructure.
        index: Number of the mesh.
    """
    metric = Metric(label_map, elements)
    origin = lattice_origin(elements, window, seed, index)
    points = lattice(window_cells(label_map)[2], label_map, elements, origin)
    points = points[np.all((points > 0) & (points < label_map.window), axis=1)]
    rng = stream(seed, index, PRIORITY)
    points = metric.thinned(points, rng.random(len(points)))
    upper, points = _notch_sides(points, elements, window)
    # Pairs come first in the order of priority: a pair never loses its one half.
    fixed = np.concatenate([upper, _mirrored(upper, window)])
    everything = np.concatenate([fixed, points])
    priority = np.concatenate([np.zeros(len(fixed)), 1.0 + rng.random(len(points))])
    priority[: len(fixed)] = np.arange(len(fixed)) / max(1, len(fixed))
    near = np.flatnonzero(_near_band(everything, elements, window))
    kept = np.ones(len(everything), dtype=np.bool_)
    kept[near] = metric.kept(everything[near], priority[near])
    points = points[kept[len(fixed) :]]
    added_upper, added = _filling(
        np.concatenate([fixed, points]), metric, elements, window, stream(seed, index, FILLING)
    )
    upper = np.concatenate([upper, added_upper])
    points = np.concatenate([points, added])
    pairs = len(upper)
    numbers = np.arange(pairs)
    return Nuclei(
        np.concatenate([upper, _mirrored(upper, window), points]),
        np.concatenate([numbers + pairs, numbers, np.full(len(points), -1)]).astype(np.int64),
        _pairwise_priority(pairs, len(points), rng),
    )


def lattice_origin(elements: Elements, window: Window, seed: int, index: int) -> FloatArray:
    """Return the point that the lattices of one mesh have in common [um]; (2,)."""
    shift = elements.length * stream(seed, index, LATTICE).random(2)
    return np.asarray(np.array([window.notch, 0.5 * window.height]) + shift)


def _mirrored(points: FloatArray, window: Window) -> FloatArray:
    return np.column_stack([points[:, 0], window.height - points[:, 1]])


def notch_band(elements: Elements) -> float:
    """Return the half height of the band of mirrored nuclei along the notch [um]."""
    return NOTCH_BAND * max(elements.width, elements.length)


def _notch_sides(
    points: FloatArray, elements: Elements, window: Window
) -> tuple[FloatArray, FloatArray]:
    """Return the nuclei above the notch that get mirror images, and those outside the band."""
    above = points[:, 1] - 0.5 * window.height
    band = (points[:, 0] < window.notch) & (np.abs(above) < notch_band(elements))
    return points[band & (above > NOTCH_GAP * elements.width)], points[~band]


def _near_band(points: FloatArray, elements: Elements, window: Window) -> BoolArray:
    """Return which points may be too close to a mirror image at the notch; (n,)."""
    reach = max(elements.width, elements.length)
    above = np.abs(points[:, 1] - 0.5 * window.height)
    near: BoolArray = above < notch_band(elements) + reach
    return near & (points[:, 0] < window.notch + reach)


def _filling(
    points: FloatArray,
    metric: Metric,
    elements: Elements,
    window: Window,
    rng: np.random.Generator,
) -> tuple[FloatArray, FloatArray]:
    """Return nuclei for holes: those above the notch that get mirror images, and the others."""
    size = np.array([window.width, window.height])
    count = np.maximum(1, np.ceil(size / min(elements.width, elements.length))).astype(np.int64)
    place = np.stack(np.meshgrid(*(np.arange(n) for n in count)), axis=-1).reshape(-1, 2)
    candidates = (place + rng.random(place.shape)) * size / count
    upper, others = _notch_sides(candidates, elements, window)
    upper = upper[metric.far_from(upper, points, HOLE)]
    upper = metric.spread(upper)
    mirrored = np.concatenate([points, upper, _mirrored(upper, window)])
    others = others[metric.far_from(others, mirrored, HOLE)]
    return upper, metric.spread(others)


def _pairwise_priority(pairs: int, others: int, rng: np.random.Generator) -> FloatArray:
    """Return random priorities, the same for both halves of a pair."""
    priority = rng.random(pairs + others)
    return np.concatenate([priority[:pairs], priority[:pairs], priority[pairs:]])
