"""The crack: broken interfaces that hang together with the notch, followed as they break."""

import heapq
import itertools
import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.outcome import Crack

LIGAMENT_DETOUR = 10.0
"""The path crosses a ligament only where the way along broken interfaces is so much longer."""

Point = tuple[float, float]

Interface = tuple[Sequence[int], Sequence[int], Sequence[Sequence[float]]]
"""Elements on both sides, junctions at both ends, and where those are [um]."""


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """A piece of the crack between two junctions.

    Attributes:
        start, end: The junctions, the one nearer the notch's tip first.
        points: Where it runs [um]; (p, 2).
        kind: "broken" interface, "ligament" of one element, or "run" of the wake.
    """

    start: int
    end: int
    points: FloatArray
    kind: Literal["broken", "ligament", "run"]


class CrackTracker:
    """Ways from the notch's tip along broken interfaces, updated and never recomputed.

    A broken interface joins two junctions of the mesh. Broken interfaces of one element belong to
    one crack even where they do not meet: an unbroken ligament of one element (cementite, mostly)
    can hold a crack together that has run on past it, and a load centred on the point before the
    ligament would raise K without bound. Adding an interface only ever shortens ways, so that
    each is relaxed from its ends (Dijkstra's algorithm on what changes).

    Args:
        notch: Tip of the notch [um].
        root: Junction of the notch's tip.
        broken: Broken interfaces that runs of the wake stand for.
    """

    def __init__(self, notch: Point, root: int, broken: int = 0) -> None:
        self._position: dict[int, Point] = {root: notch}
        self._edges: dict[int, list[tuple[int, float]]] = {root: []}
        self._cost: dict[int, float] = {root: 0.0}
        self._parent: dict[int, int] = {}
        self._of_element: defaultdict[int, set[int]] = defaultdict(set)
        self._root = self._tip = root
        self._tips: dict[tuple[int, ...], Point] = {}
        self._runs: dict[tuple[int, int], FloatArray] = {}
        self.broken = broken

    def add_run(self, start: int, end: int, points: FloatArray) -> None:
        """Add a run of the crack whose interfaces are not known any more.

        Args:
            start, end: Junctions at its ends.
            points: Where it runs [um]; (p, 2).
        """
        for junction, (x, y) in ((start, points[0].tolist()), (end, points[-1].tolist())):
            self._position.setdefault(junction, (x, y))
        self._runs[start, end], self._runs[end, start] = points, points[::-1]
        cost = float(np.hypot(*np.diff(points, axis=0).T).sum())
        self._edges.setdefault(start, []).append((end, cost))
        self._edges.setdefault(end, []).append((start, cost))
        self._relax([start, end], move_tip=True)

    def ways_to(self, reach: float) -> list[Way]:
        """Return all pieces of the ways to the tip and to what lies no further from it than a reach.

        Args:
            reach: [um].
        """
        here = self.tip
        wanted = [
            junction
            for junction in self._cost
            if math.dist(self._position[junction], here) <= reach or junction == self._tip
        ]
        seen = {self._root}
        ways = []
        for junction in wanted:
            while junction not in seen:
                seen.add(junction)
                before = self._parent[junction]
                ways.append(self._piece(before, junction))
                junction = before
        return ways

    def add(
        self, pairs: IntArray, junctions: IntArray, ends: FloatArray, *, notch: bool = False
    ) -> list[Point]:
        """Add broken interfaces and return the points that were newly reached from the notch.

        Args:
            pairs: Elements on both sides of each; shape (b, 2).
            junctions: Junctions at both ends of each; shape (b, 2).
            ends: Where those are [um]; shape (b, 2, 2).
            notch: Whether they are the notch's own, which count as no growth.
        """
        reached: list[Point] = []
        self._tips.clear()
        for elements, (a, b), (start, end) in zip(
            pairs.tolist(), junctions.tolist(), ends.tolist(), strict=True
        ):
            for junction, point in ((a, start), (b, end)):
                self._position.setdefault(junction, (point[0], point[1]))
            self._join(a, b, 1.0)
            for element in elements:
                for other in self._of_element[element]:
                    for junction in {a, b} - {other}:
                        self._join(junction, other, LIGAMENT_DETOUR)
                self._of_element[element] |= {a, b}
            reached += self._relax([a, b], move_tip=not notch)
        if not notch:
            self.broken += len(junctions)
        return reached

    def tip_after(self, interface: Interface) -> Point:
        """Return where the tip would be [um] if one more interface broke."""
        ends = tuple(interface[1])
        found = self._tips.get(ends)
        if found is None:
            reached = self.reached_after([interface])
            found = self._tips[ends] = max([self.tip, *reached], key=lambda point: point[0])
        return found

    def reached_after(self, interfaces: Sequence[Interface]) -> list[Point]:
        """Return the points [um] that the crack would reach beside its own if some more broke."""
        position: dict[int, Point] = {}
        seen: set[int] = set()
        left = list(interfaces)
        joined = True
        while joined:
            joined = False
            for interface in left.copy():
                elements, junctions, ends = interface
                touched = set(junctions).union(*(self._of_element.get(e, ()) for e in elements))
                if touched.isdisjoint(seen) and self._cost.keys().isdisjoint(touched):
                    continue
                left.remove(interface)
                joined = True
                position |= {place: (x, y) for place, (x, y) in zip(junctions, ends, strict=True)}
                waiting = [item for item in touched - seen if item not in self._cost]
                seen |= set(waiting)
                while waiting:
                    ways = self._edges.get(waiting.pop(), ())
                    new = {other for other, _ in ways if other not in self._cost} - seen
                    waiting += new
                    seen |= new
        return [self._position.get(junction) or position[junction] for junction in seen]

    def crack(self) -> Crack:
        """Return the crack as it is."""
        path = self._path()
        return Crack(self.tip[0], self.tip, path, self.path_length, self.broken)

    @property
    def tip(self) -> Point:
        """Furthest point in x of the crack [um]."""
        return self._position[self._tip]

    @property
    def path_length(self) -> float:
        """Length of the shortest way from the notch's tip to the crack's [um]."""
        points = self._path().tolist()
        return sum(map(math.dist, points[:-1], points[1:]))

    def _path(self) -> FloatArray:
        """Return the vertices of the way to the tip [um]; (p, 2)."""
        way = self._way()
        parts = [self._piece(*step).points[1:] for step in itertools.pairwise(way)]
        return np.concatenate([np.array([self._position[way[0]]]), *parts])

    def _piece(self, start: int, end: int) -> Way:
        points = self._runs.get((start, end))
        if points is not None:
            return Way(start, end, points, "run")
        points = np.array([self._position[start], self._position[end]])
        cost = self._cost[end] - self._cost[start]
        crossed = cost > 0.5 * LIGAMENT_DETOUR * math.dist(*points.tolist())
        return Way(start, end, points, "ligament" if crossed else "broken")

    def _way(self) -> list[int]:
        way = [self._tip]
        while way[-1] != self._root:
            way.append(self._parent[way[-1]])
        return way[::-1]

    def _join(self, a: int, b: int, factor: float) -> None:
        cost = factor * math.dist(self._position[a], self._position[b])
        self._edges.setdefault(a, []).append((b, cost))
        self._edges.setdefault(b, []).append((a, cost))

    def _relax(self, start: list[int], *, move_tip: bool) -> list[Point]:
        reached = []
        # A new edge may join a known junction to an unknown one: begin at the known neighbours.
        known = {item for item in start if item in self._cost}
        known |= {other for item in start for other, _ in self._edges[item] if other in self._cost}
        queue = [(self._cost[item], item) for item in known]
        heapq.heapify(queue)
        while queue:
            cost, junction = heapq.heappop(queue)
            if cost > self._cost[junction]:
                continue
            for other, step in self._edges[junction]:
                way = cost + step
                before = self._cost.get(other)
                if before is not None and before <= way:
                    continue
                if before is None:
                    reached.append(self._position[other])
                    if move_tip and self._position[other][0] > self.tip[0]:
                        self._tip = other
                self._cost[other] = way
                self._parent[other] = junction
                heapq.heappush(queue, (way, other))
        return reached
