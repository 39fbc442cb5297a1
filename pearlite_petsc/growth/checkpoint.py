"""All that continuing a crack needs: saved between two steps, restored on as many ranks."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.crack import Point
from pearlite_petsc.fatigue.damage_state import DamageState
from pearlite_petsc.growth.record import Record
from pearlite_petsc.growth.refinement import Refinement
from pearlite_petsc.solver.equilibrium_state import EquilibriumState

if TYPE_CHECKING:
    from pearlite_petsc.growth.domain import Domain

FORM = 7
"""Number of what a checkpoint holds and means; to be raised with every change of it."""

Change = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class CouplingState:
    """What the next block depends on beside damage and jumps.

    Attributes:
        set_up_damage: Damage that the compliance's factors were made for; (k,).
        numbers: Interfaces that it knows, in the order in which they were added; (s,).
        batch: With which others each was added, from 0; (s,).
        pull_tip: Tip for which the pull of the load is known [um].
    """

    set_up_damage: FloatArray
    numbers: IntArray
    batch: IntArray
    pull_tip: Point


@dataclass(frozen=True, slots=True, eq=False)
class Checkpoint:
    """A crack between two steps.

    Attributes:
        refinement: Where the mesh is fine.
        damage: Where the damage of its interfaces stands.
        equilibrium: What the next solve depends on beside.
        coupling: Compliance of what softened, None where the next block makes another one.
        record: What was measured and counted so far.
    """

    refinement: Refinement
    damage: DamageState
    equilibrium: EquilibriumState
    coupling: CouplingState | None
    record: Record

    def gathered(self, domain: "Domain") -> "Checkpoint | None":
        """Return the checkpoint of the whole mesh on rank 0, None elsewhere. Collective."""
        whole = self._changed(
            lambda values: _or_none(domain.gather(values)),
            lambda values: _or_none(domain.gather_elements(values)),
        )
        return whole if domain.comm.rank == 0 else None

    def without_arrays(self) -> "Checkpoint":
        """Return the checkpoint with empty arrays of interfaces and elements, and no nuclei."""
        light = self._changed(_none, _none)
        return replace(light, refinement=replace(self.refinement, kept=None))

    def scattered(self, domain: "Domain") -> "Checkpoint":
        """Return what this rank has of a checkpoint. Collective.

        To be called of the whole one on rank 0, of one ``without_arrays`` elsewhere.
        """
        return self._changed(domain.scatter, domain.scatter_elements)

    def _changed(self, of_interfaces: Change, of_elements: Change) -> "Checkpoint":
        """Return the checkpoint with every array changed, one after the other in one order."""
        solver, coupling = self.equilibrium, self.coupling
        if coupling is not None:
            coupling = replace(coupling, set_up_damage=of_interfaces(coupling.set_up_damage))
        return replace(
            self,
            damage=self.damage.on_interfaces(of_interfaces),
            equilibrium=replace(
                solver,
                set_up_damage=of_interfaces(solver.set_up_damage),
                solution=of_elements(solver.solution),
            ),
            coupling=coupling,
        )


def _none(values: FloatArray) -> FloatArray:
    return np.empty((0, *values.shape[1:]))


def _or_none(values: FloatArray | None) -> FloatArray:
    return np.empty(0) if values is None else values
