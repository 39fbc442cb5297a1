"""What an equilibrium needs to go on bit for bit, without PETSc."""

from dataclasses import dataclass

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.solver.reuse import ReusePolicy


@dataclass(frozen=True, slots=True, eq=False)
class EquilibriumState:
    """What the next solve depends on beside the damage, on one rank.

    Attributes:
        set_up_damage: Damage that the preconditioner was made for; (k,).
        solution: Last solution on owned elements; (owned, 3).
        policy: How long the preconditioner is reused.
    """

    set_up_damage: FloatArray
    solution: FloatArray
    policy: ReusePolicy
