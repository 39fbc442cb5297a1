"""Compliance of a few interfaces in the whole body, from factors kept while they soften."""

from collections.abc import Sequence

import numpy as np
from mpi4py import MPI

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.krylov import stage
from pearlite_petsc.solver.owners import from_owners, owned_interfaces
from pearlite_petsc.solver.woodbury import Woodbury

MOST_AT_ONCE = 4e6
"""Values of the right-hand sides that are solved for at once."""


class Compliance:
    """Jumps of chosen interfaces to pairs of unit forces on each other. Collective.

    The factors are those of one damage. Each interface that is added costs three
    back-substitutions once; how far it and the others have softened since enters by the
    Sherman-Morrison-Woodbury formula, so that no later damage needs new factors.

    Attributes:
        numbers: Global numbers of the interfaces in the order in which they were added; (s,).
        batch: With which others each of them was solved for, from 0; (s,).

    Args:
        equilibrium: Makes and holds the factors.
        damage: Of the factors, on this rank's interfaces, from now on read-only; (k,).
    """

    def __init__(self, equilibrium: Equilibrium, damage: FloatArray) -> None:
        self._equilibrium, self._system = equilibrium, equilibrium.system
        self._subdomain, self._comm = self._system.subdomain, self._system.comm
        self._factors = equilibrium.factors(damage)
        self._constants = self._subdomain.interfaces.spring_constants()
        self.numbers = np.empty(0, dtype=np.int64)
        self.batch = np.empty(0, dtype=np.int64)
        self._matrix = np.empty((0, 0))
        self._columns = np.empty((3 * self._subdomain.owned_count, 0), order="F")

    @property
    def set_up_damage(self) -> FloatArray:
        """Damage that the factors were made for; (k,)."""
        return self._factors.damage

    @property
    def is_outdated(self) -> bool:
        """Whether the equilibrium has other factors by now."""
        return not self._equilibrium.holds(self._factors)

    def add(self, numbers: IntArray) -> None:
        """Add interfaces, those added before left out. Collective.

        Args:
            numbers: Global ones, the same on all ranks; (a,).
        """
        known = set(self.numbers.tolist())
        new = np.array([n for n in numbers.tolist() if n not in known], dtype=np.int64)
        most = max(1, int(MOST_AT_ONCE / (9 * self._subdomain.element_count)))
        for start in range(0, len(new), most):
            self._add(new[start : start + most])
        if len(new) and self._factors.are_preconditioner:
            self._factors.woodbury = self._woodbury()

    def _add(self, new: IntArray) -> None:
        self._equilibrium.counters["unit_loads"] += 3 * len(new)
        before = 3 * len(self.numbers)
        number = self.batch[-1] + 1 if before else 0
        self.numbers = np.concatenate([self.numbers, new])
        self.batch = np.concatenate([self.batch, np.full(len(new), number)])
        row, place = owned_interfaces(self._subdomain, self.numbers)
        with stage("solve"):
            unknowns = self._under_unit_pairs(new)[self._subdomain.interfaces.elements[place]]
        opened = np.zeros((len(self.numbers), 3, 3 * len(new)))
        unknowns = unknowns.reshape(len(place), 6, 3 * len(new))
        opened[row] = self._system.operator[place] @ unknowns
        if self._comm.size > 1:
            self._comm.Allreduce(MPI.IN_PLACE, opened)
        grown = np.empty((3 * len(self.numbers),) * 2)
        grown[:before, :before] = self._matrix
        grown[:, before:] = opened.reshape(len(grown), -1)
        # Maxwell and Betti: what those added before do to the new ones need not be solved for.
        grown[before:, :before] = grown[:before, before:].T
        self._matrix = grown

    def response(self, loads: Sequence[FloatArray]) -> FloatArray:
        """Return the jumps of the subdomain's interfaces under loads, at the set-up damage. Collective.

        Args:
            loads: (F_x, F_y, M) on owned elements [uN, uN, uN um]; (owned, 3) each.

        Returns:
            Shape (k, 3, loads).
        """
        found = []
        for load in loads:
            with stage("solve"):
                unknowns = self._factors.solve(self._subdomain.right_hand_side(load))
                found.append(self._system.jumps(unknowns))
        return np.stack(found, axis=2)

    def at(
        self, numbers: IntArray, damage: FloatArray, response: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the compliance of some interfaces and a response at another damage. Collective.

        Args:
            numbers: Global ones, all added, the same on all ranks; (a,).
            damage: Of the subdomain's interfaces; (k,).
            response: What ``response`` returned; (k, 3, l).

        Returns:
            C (3 a, 3 a) and the response of those interfaces (a, 3, l).
        """
        springs = from_owners(self._comm, self._subdomain, self.numbers, self._constants)
        since = from_owners(self._comm, self._subdomain, self.numbers, damage - self.set_up_damage)
        let_go = (springs * since[:, None]).ravel()
        row = {number: row for row, number in enumerate(self.numbers.tolist())}
        chosen = np.array([row[number] for number in numbers.tolist()], dtype=np.int64)
        rows = (3 * chosen[:, None] + np.arange(3)).ravel()
        given = from_owners(self._comm, self._subdomain, self.numbers, response)
        given = given.reshape(len(let_go), -1)
        system = np.eye(len(let_go)) - self._matrix * let_go
        found = np.linalg.solve(system, np.concatenate([self._matrix[:, rows], given], axis=1))
        compliance = found[rows, : len(rows)]
        return compliance, found[rows, len(rows) :].reshape(len(chosen), 3, -1)

    def _woodbury(self) -> Woodbury:
        """Return what turns the factors into those of another damage of the interfaces added."""
        _, place = owned_interfaces(self._subdomain, self.numbers)
        return Woodbury(
            place=place,
            damage=self.set_up_damage[place],
            constants=self._constants[place],
            compliance=self._matrix,
            operator=self._system.operator[place],
            unknowns=self._unknowns_of(place),
            columns=self._columns,
        )

    def _unknowns_of(self, place: IntArray) -> IntArray:
        """Return which unknowns B of this rank's interfaces takes; (a, 6)."""
        elements = self._subdomain.element_numbers[self._subdomain.interfaces.elements[place]]
        return np.asarray((3 * elements[:, :, None] + np.arange(3)).reshape(-1, 6))

    def _under_unit_pairs(self, numbers: IntArray) -> FloatArray:
        """Return the unknowns under unit pairs that open each jump of some interfaces. Collective.

        Shape (owned + g, 3, 3 a).
        """
        row, place = owned_interfaces(self._subdomain, numbers)
        values = self._system.operator[place]
        found = self._factors.solve_triples(row, self._unknowns_of(place), values, len(numbers))
        if self._factors.are_preconditioner:
            columns = found.reshape(len(self._columns), -1)
            self._columns = np.concatenate([self._columns, columns], axis=1)
        return found
