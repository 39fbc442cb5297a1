"""All that continuing a crack needs, as numbers and arrays that any file format can hold."""

from dataclasses import astuple, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.solver.reuse import ReusePolicy

FORM = 6
"""Number of what a checkpoint holds and means; to be raised with every change of it."""

_SMALL = ("history", "zone_boxes", "zone_discs", "reuse", "coupling_taken", "coupling_tip")


@dataclass(frozen=True, slots=True, eq=False)
class Checkpoint:
    """A crack between two steps, for the mesh of rank 0's numbering.

    Attributes:
        numbers: Scalars by name.
        counters: Counts of the solver by name.
        arrays: Arrays by name: damage, history, fine zone, last solution and so on.
    """

    numbers: dict[str, float]
    counters: dict[str, int]
    arrays: dict[str, NDArray[Any]]

    def without_large(self) -> tuple[dict[str, float], dict[str, int], dict[str, NDArray[Any]]]:
        """Return numbers, counters and the arrays that every rank needs whole."""
        return self.numbers, self.counters, {name: self.arrays[name] for name in _SMALL}

    def equals(self, other: "Checkpoint") -> bool:
        """Return whether both hold the same values bit for bit, wall time aside."""
        mine, theirs = ({**item.numbers, "wall_s": 0.0} for item in (self, other))
        return (
            mine == theirs
            and self.counters == other.counters
            and self.arrays.keys() == other.arrays.keys()
            and all(
                np.array_equal(value, other.arrays[name], equal_nan=True)
                for name, value in self.arrays.items()
            )
        )


def policy_as_array(policy: ReusePolicy) -> FloatArray:
    """Return the fields of a policy in their order; (7,)."""
    return np.array(astuple(policy), dtype=float)


def policy_from_array(values: FloatArray) -> ReusePolicy:
    """Return the policy that ``policy_as_array`` took apart."""
    setup_cost, first_iterations, excess, *flags = values.tolist()
    return ReusePolicy(setup_cost, int(first_iterations), excess, *map(bool, flags))
