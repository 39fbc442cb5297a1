"""Which interfaces soften together in a block, and what couples them."""

import math
from dataclasses import replace

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.crack import CrackTracker
from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.fatigue.softening import FollowingLoad, Softening
from pearlite_petsc.growth.checkpoint import CouplingState
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.growth.load import TipLoad
from pearlite_petsc.scene import Window
from pearlite_petsc.solver.compliance import Compliance
from pearlite_petsc.solver.owners import from_owners, local_interfaces, owned_interfaces

LEAST_GAIN, MOST_COUPLED = 0.01, 20
"""Damage that an interface gains in a block from which it counts as softening, and how many do."""

CHANGED = 0.02
"""Change of damage from which the compliance of the others has to know of an interface."""

MOST_ADDED = 60
"""Interfaces of one set of factors; then new factors are cheaper."""

PULL_REACH = 0.1
"""Fraction of its distance from the window's edge that the tip may move until the pull of the load is
computed anew.
"""

_PULL = 1.0
"""Length over which the load is moved to see what that does [um]."""


class Coupling:
    """Knows the mutual compliance of the interfaces that soften together. Collective.

    Attributes:
        compliance: Of what softened since its factors were made; None before the first block.

    Args:
        domain: The mesh.
        tracker: The crack.
        load: Load on owned elements.
        window: The window.
    """

    def __init__(
        self, domain: Domain, tracker: CrackTracker, load: TipLoad, window: Window
    ) -> None:
        self._domain, self._tracker, self._load, self._window = domain, tracker, load, window
        self._constants = domain.subdomain.interfaces.spring_constants()
        self.compliance: Compliance | None = None
        self._pull: FloatArray | None = None
        self._pull_tip = tracker.tip

    def softening_interfaces(self, gain: FloatArray) -> IntArray:
        """Return the global numbers of the interfaces that will soften, ascending; (a,). Collective.

        Args:
            gain: Damage that each interface of this rank will gain in the block; (k,).
        """
        subdomain = self._domain.subdomain
        chosen = np.flatnonzero((gain > LEAST_GAIN) & subdomain.owns_interface)
        mine = np.stack([-gain[chosen], subdomain.interfaces.numbers[chosen]], axis=1)
        found = np.concatenate(self._domain.comm.allgather(mine))
        most = found[np.lexsort(found.T[::-1])[:MOST_COUPLED], 1]
        return np.sort(most.astype(np.int64))

    def values_of(self, numbers: IntArray, values: FloatArray) -> FloatArray:
        """Return values of some interfaces on all ranks, each from its owner. Collective.

        Args:
            numbers: Global numbers; (a,).
            values: Of this rank's interfaces; (k, ...).
        """
        return from_owners(self._domain.comm, self._domain.subdomain, numbers, values)

    def with_values(self, numbers: IntArray, values: FloatArray, new: FloatArray) -> FloatArray:
        """Return values of this rank's interfaces with some of them replaced; (k, ...).

        Args:
            numbers: Global numbers of those; (a,).
            values: Of this rank's interfaces; (k, ...).
            new: Of those; (a, ...).
        """
        row, place = local_interfaces(self._domain.subdomain, numbers)
        result = values.copy()
        result[place] = new[row]
        return result

    def softening(
        self,
        numbers: IntArray,
        drive: Drive,
        jump: FloatArray,
        stiffness_ratio: FloatArray,
        limit: FloatArray,
    ) -> Softening:
        """Return the interfaces at the start of a block, the same on all ranks.

        Args:
            numbers: Their global numbers, ascending; (a,).
            drive: Of this rank's interfaces; (k,).
            jump: Likewise [um, um, rad]; (k, 3).
            stiffness_ratio: g of each alone; (k,).
            limit: D at which the block ends; (k,).
        """
        compliance, pull = self._compliance(numbers, drive.damage)
        stiffness = self._domain.subdomain.interfaces.stiffness
        columns = [
            drive.damage,
            limit,
            stiffness_ratio,
            drive.rates.factor,
            drive.rates.threshold,
            *jump.T,
            *self._constants.T,
            stiffness.k_n,
            stiffness.k_t,
        ]
        _, place = owned_interfaces(self._domain.subdomain, numbers)
        advance = np.zeros((len(drive.damage), 2))
        for number in place:
            advance[number] = self._advance(number)
        table = self.values_of(numbers, np.column_stack([*columns, advance]))
        damage, limit, ratio, factor, threshold = table[:, :5].T
        return Softening(
            damage=damage,
            limit=limit,
            jump=table[:, 5:8],
            constants=table[:, 8:11],
            springs=table[:, 11:13],
            compliance=compliance,
            rates=replace(drive.rates, factor=factor, threshold=threshold),
            nominal=drive.nominal,
            load=FollowingLoad(damage, ratio, table[:, 13:15], pull),
        )

    def state(self) -> CouplingState | None:
        """Return what ``restore`` needs, None where the next block makes another compliance."""
        known = self.compliance
        if known is None or known.is_outdated:
            return None
        return CouplingState(known.set_up_damage, known.numbers, known.batch, self._pull_tip)

    def restore(self, state: CouplingState) -> None:
        """Go on from a state. Collective."""
        compliance = self.compliance = Compliance(self._domain.equilibrium, state.set_up_damage)
        for number in range(state.batch.max(initial=-1) + 1):
            compliance.add(state.numbers[state.batch == number])
        self._pull_tip = state.pull_tip
        self._pull = self._pulls(compliance)

    def _compliance(self, numbers: IntArray, damage: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return C (3 a, 3 a) and the pull of the load (a, 3, 2) at the damage of now. Collective."""
        compliance = self.compliance
        if compliance is None or compliance.is_outdated:
            compliance = self._factored(damage)
        wanted = np.union1d(numbers, self._changed(compliance, damage))
        if len(np.union1d(compliance.numbers, wanted)) > MOST_ADDED and len(compliance.numbers):
            compliance, wanted = self._factored(damage), numbers
        compliance.add(wanted)
        if self._pull is None or self._has_left_pull():
            self._pull_tip = self._tracker.tip
            self._pull = self._pulls(compliance)
        return compliance.at(numbers, damage, self._pull)

    def _factored(self, damage: FloatArray) -> Compliance:
        """Return the compliance from factors of a damage (k,); no pull is known. Collective."""
        self.compliance = Compliance(self._domain.equilibrium, damage)
        self._pull = None
        return self.compliance

    def _changed(self, compliance: Compliance, damage: FloatArray) -> IntArray:
        """Return the global numbers of all that softened since the factors were made. Collective."""
        domain = self._domain
        far = np.abs(damage - compliance.set_up_damage) > CHANGED
        mine = domain.subdomain.interfaces.numbers[far & domain.subdomain.owns_interface]
        return np.asarray(np.concatenate(domain.comm.allgather(mine)))

    def _has_left_pull(self) -> bool:
        """Return whether the tip has moved so far that the load's pull there is another one."""
        window, (x, y) = self._window, self._pull_tip
        room = min(window.width - x, y, window.height - y)
        return math.dist(self._pull_tip, self._tracker.tip) > PULL_REACH * room

    def _pulls(self, compliance: Compliance) -> FloatArray:
        x, y = self._pull_tip
        # Central differences, or a mirrored body would not be one.
        half = 0.5 * _PULL
        ahead = self._load.at((x + half, y)), self._load.at((x, y + half))
        behind = self._load.at((x - half, y)), self._load.at((x, y - half))
        moved = zip(ahead, behind, strict=True)
        return compliance.response([(there - here) / _PULL for there, here in moved])

    def _advance(self, place: int) -> tuple[float, float]:
        """Return how far the tip would go if an interface broke [um]."""
        subdomain, interfaces = self._domain.subdomain, self._domain.subdomain.interfaces
        elements = subdomain.element_numbers[interfaces.elements[place]].tolist()
        junctions, ends = interfaces.junctions[place].tolist(), interfaces.ends[place].tolist()
        x, y = self._tracker.tip_after((elements, junctions, ends))
        return x - self._tracker.tip[0], y - self._tracker.tip[1]
