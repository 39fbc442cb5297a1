"""Which part of a crack lies so far behind its tip that its elements may coarsen."""

from collections import Counter, defaultdict

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray, IntArray
from pearlite_petsc.fatigue.crack import CrackTracker, Point, Way
from pearlite_petsc.growth.refinement import CARRIED_DAMAGE, interface_keys
from pearlite_petsc.scene import Elements, Kind
from pearlite_petsc.tessellation.mesh import Mesh
from pearlite_petsc.tessellation.wake import STAYING, Wake, wake_of

BEHIND = 2.0
"""Distance behind the tip from which the crack is wake, in radii of the fine zone."""

SHORTEST = 3
"""Fewest broken interfaces that a run stands for; fewer stay as they are."""


def is_near_tip(points: FloatArray, tip: Point, elements: Elements, more: float = 0.0) -> BoolArray:
    """Return which points are no wake because they lie near the tip or ahead of it; (n,).

    Args:
        points: [um]; (n, 2).
        tip: Of the crack [um].
        elements: Radius of the fine zone.
        more: Added to the distance [um].
    """
    gap = points - np.array(tip)
    distance = np.hypot(gap[:, 0], gap[:, 1])
    return np.asarray((distance < BEHIND * elements.radius + more) | (gap[:, 0] > -more))


def crack_wake(tracker: CrackTracker, notch: Point, elements: Elements) -> Wake:
    """Return the wake of a crack; what it stands for is not known yet.

    The crack stays as it is near its tip, at the notch's and round every ligament: its own damage
    decides whether that goes on to hold the crack together.

    Args:
        tracker: The crack.
        notch: Tip of the notch [um].
        elements: Sizes.
    """
    ways = tracker.ways_to(BEHIND * elements.radius)
    middle = np.array([0.5 * (way.points[0] + way.points[-1]) for way in ways]).reshape(-1, 2)
    holding = np.array([way.kind == "ligament" for way in ways], dtype=np.bool_)
    stay = np.concatenate([np.array([notch]), middle[holding]])
    near = is_near_tip(middle, tracker.tip, elements) | _within(middle, stay, elements)
    near[[row for row, way in enumerate(ways) if way.kind == "run"]] = False
    runs = []
    for chain in _chains(ways, near):
        if len(chain) < SHORTEST and all(way.kind == "broken" for way in chain):
            centres = [0.5 * (way.points[0] + way.points[-1]) for way in chain]
            stay = np.concatenate([stay, np.array(centres)])
        else:
            runs.append(_joined(chain))
    near_tip = is_near_tip(stay, tracker.tip, elements, -2.0 * STAYING * elements.length)
    return wake_of(runs, stay[~near_tip])


def staying_interfaces(
    mesh: Mesh, damage: FloatArray, wake: Wake, tip: Point, elements: Elements
) -> BoolArray:
    """Return the damaged interfaces that must stay as they are; (k,).

    Args:
        mesh: The mesh.
        damage: D; (k,).
        wake: Of the crack.
        tip: Of the crack [um].
        elements: Sizes.
    """
    # More than what is no wake: every piece of the crack is in a run or stays.
    more = max(elements.width, elements.length)
    near = is_near_tip(mesh.midpoint, tip, elements, more)
    near |= _within(mesh.midpoint, wake.stay, elements, more)
    return np.asarray((damage > CARRIED_DAMAGE) & (mesh.kind != Kind.NOTCH) & near)


def lost_pairs(old: Mesh, new: Mesh, damage: FloatArray) -> IntArray:
    """Return the nuclei on both sides of the broken interfaces that a new mesh has not; (b, 2).

    Args:
        old, new: The meshes.
        damage: D of the old mesh's interfaces; (k,).
    """
    broken = np.flatnonzero((damage >= 1.0) & (old.kind != Kind.NOTCH))
    there = interface_keys(new)[new.kind != Kind.NOTCH]
    lost = broken[~np.isin(interface_keys(old)[broken], there)]
    return np.sort(old.nucleus[old.interface_elements[lost]], axis=1)


def _within(
    points: FloatArray, centres: FloatArray, elements: Elements, more: float = 0.0
) -> BoolArray:
    radius = STAYING * max(elements.width, elements.length) + more
    near = np.zeros(len(points), dtype=np.bool_)
    for centre in centres:
        near |= np.hypot(*(points - centre).T) < radius
    return near


def _chains(ways: list[Way], near: BoolArray) -> list[list[Way]]:
    """Return the pieces that are wake, those that follow each other without a branch together."""
    degree = Counter(junction for way in ways for junction in (way.start, way.end))
    at: defaultdict[int, list[Way]] = defaultdict(list)
    wake = [way for way, stays in zip(ways, near.tolist(), strict=True) if not stays]
    for way in wake:
        at[way.start].append(way)
    ends = {way.end for way in wake}
    chains = []
    for way in wake:
        if degree[way.start] == 2 and way.start in ends:
            continue
        chain = [way]
        while degree[chain[-1].end] == 2 and at[chain[-1].end]:
            chain.append(at[chain[-1].end][0])
        chains.append(chain)
    return chains


def _joined(chain: list[Way]) -> FloatArray:
    return np.concatenate([chain[0].points[:1], *(way.points[1:] for way in chain)])
