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

    def tip_after(
        self, elements: Sequence[int], junctions: Sequence[int], ends: Sequence[Sequence[float]]
    ) -> Point:
        """Return where the tip would be [um] if one more interface broke.

        Args:
            elements: On both sides of it.
            junctions: At its ends.
            ends: Where those are [um].
        """
        touched = set(junctions).union(*(self._of_element.get(item, ()) for item in elements))
        tip = self.tip
        if self._cost.keys().isdisjoint(touched):
            return tip
        position = dict(zip(junctions, ends, strict=True))
        seen = {junction for junction in touched if junction not in self._cost}
        waiting = list(seen)
        while waiting:
            junction = waiting.pop()
            x, y = self._position.get(junction) or position[junction]
            if x > tip[0]:
                tip = x, y
            new = {other for other, _ in self._edges.get(junction, ()) if other not in self._cost}
            waiting += new - seen
            seen |= new
        return tip

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
