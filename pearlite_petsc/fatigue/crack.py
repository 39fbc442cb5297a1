"""The crack: broken interfaces that hang together with the notch, followed as they break."""

import heapq
import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.outcome import Crack

LIGAMENT_DETOUR = 10.0
"""The path crosses a ligament only where the way along broken interfaces is so much longer."""

Point = tuple[float, float]

Interface = tuple[Sequence[int], Sequence[int], Sequence[Sequence[float]]]
"""Elements on both sides, junctions at both ends, and where those are [um]."""


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
    """

    def __init__(self, notch: Point, root: int) -> None:
        self._position: dict[int, Point] = {root: notch}
        self._edges: dict[int, list[tuple[int, float]]] = {root: []}
        self._cost: dict[int, float] = {root: 0.0}
        self._parent: dict[int, int] = {}
        self._of_element: defaultdict[int, set[int]] = defaultdict(set)
        self._root = self._tip = root
        self._tips: dict[tuple[int, ...], Point] = {}
        self.broken = 0

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
        path = np.array([self._position[junction] for junction in self._way()])
        return Crack(self.tip[0], self.tip, path, self.path_length, self.broken)

    @property
    def tip(self) -> Point:
        """Furthest point in x of the crack [um]."""
        return self._position[self._tip]

    @property
    def path_length(self) -> float:
        """Length of the shortest way from the notch's tip to the crack's [um]."""
        points = [self._position[junction] for junction in self._way()]
        return sum(map(math.dist, points[:-1], points[1:]))

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
