"""The input and output of a cycle jump.

A cycle jump is called with the ``Situation`` at the start of a block. It returns a ``Block``, or
None if no interface has a rate (arrest). A cycle jump that needs the equilibrium at another damage
is a generator: as often as it wants, it yields a ``Trial`` and is sent the jumps of the interfaces
there; in the end it returns its block. The caller ends the block at a trial that brings the crack
to the window's edge, where an equilibrium need not exist.
"""

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field
from typing import Protocol, TypeAlias

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.drive import Drive
from pearlite_petsc.fatigue.softening import Softening
from pearlite_petsc.laws.damage import RateConstants
from pearlite_petsc.mechanics.springs import Stiffness


@dataclass(frozen=True, slots=True, eq=False)
class Memory:
    """What a cycle jump remembers from one block to the next.

    Attributes:
        by_interface: Arrays by name; (k,) each. NaN means that nothing is known; values are set
            to NaN after a break nearby. The arrays are dropped with the mesh.
        numbers: Numbers by name, the same on all ranks.
    """

    by_interface: Mapping[str, FloatArray] = field(default_factory=dict)
    numbers: Mapping[str, float] = field(default_factory=dict)


class Coupling(Protocol):
    """The elastic coupling of the interfaces that soften together. Its methods are collective.

    Interfaces are named by their numbers in the whole mesh; all ranks pass the same numbers.
    """

    def softening_interfaces(self, gain: FloatArray) -> IntArray:
        """Return the numbers of the interfaces that count as softening, ascending; (a,).

        Args:
            gain: Damage that each interface will gain in the block; (k,).
        """

    def values_of(self, numbers: IntArray, values: FloatArray) -> FloatArray:
        """Return values (k, ...) of some interfaces; (a, ...)."""

    def with_values(self, numbers: IntArray, values: FloatArray, new: FloatArray) -> FloatArray:
        """Return values (k, ...) with those of some interfaces replaced by new ones (a, ...)."""

    def softening(
        self,
        numbers: IntArray,
        drive: Drive,
        jump: FloatArray,
        stiffness_ratio: FloatArray,
        limit: FloatArray,
    ) -> Softening:
        """Return some interfaces at the start of a block, with their mutual compliance.

        Args:
            numbers: Numbers of these interfaces; (a,).
            drive: Drive of all interfaces; (k,).
            jump: Jumps of all interfaces [um, um, rad]; (k, 3).
            stiffness_ratio: g of each; (k,).
            limit: D at which the block ends; (k,).
        """


@dataclass(frozen=True, slots=True, eq=False)
class Situation:
    """The state of the interfaces at the start of a block; arrays hold this rank's interfaces.

    Attributes:
        damage: D; (k,).
        jump: Normal, tangential and rotational jump in equilibrium [um, um, rad]; (k, 3).
        stiffness: Stiffness of the intact springs.
        rates: Rate constants of the interfaces.
        failure_damage: D at which an interface breaks.
        nominal: Whether the law takes (1 - D) times the effective stress.
        stiffness_ratio: g of each interface; (k,).
        coupling: What couples the interfaces.
        memory: The memory that the block before returned.
        least, greatest: Functions that return the least and the greatest of a number over all
            ranks; every rank must call them equally often.
    """

    damage: FloatArray
    jump: FloatArray
    stiffness: Stiffness
    rates: RateConstants
    failure_damage: float
    nominal: bool
    stiffness_ratio: FloatArray
    coupling: Coupling
    memory: Memory = field(default_factory=Memory)
    least: Callable[[float], float] = float
    greatest: Callable[[float], float] = float

    @property
    def drive(self) -> Drive:
        """What drives the interfaces now."""
        return self.drive_at(self.damage, self.jump)

    def drive_at(self, damage: FloatArray, jump: FloatArray) -> Drive:
        """Return what drives the interfaces at another damage (k,) and the jumps there (k, 3)."""
        normal, shear = (stress * (damage < 1.0) for stress in self.stresses(jump))
        return Drive(damage, normal, shear, self.rates, self.failure_damage, self.nominal)

    def stresses(self, jump: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return effective normal and shear stress k_0 jump [MPa], broken or not; (k,) each."""
        return self.stiffness.k_n * jump[:, 0], self.stiffness.k_t * jump[:, 1]


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """A damage at which a cycle jump asks for the equilibrium.

    Attributes:
        cycles: Since the block's start.
        damage: D, 1 where an interface breaks; (k,).
    """

    cycles: float
    damage: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """A block of cycles.

    Attributes:
        cycles: How long it is.
        damage: D at its end, 1 where an interface breaks; (k,).
        jump: Jumps at its end [um, um, rad], None where they are still to be solved for; (k, 3).
        memory: What the next block is to know.
        counts: What happened, by name, for the outcome's counters.
    """

    cycles: float
    damage: FloatArray
    jump: FloatArray | None = None
    memory: Memory = field(default_factory=Memory)
    counts: Mapping[str, int] = field(default_factory=dict)


Trials: TypeAlias = Generator[Trial, FloatArray, Block | None]
"""Yields trials, is sent the jumps there (k, 3), returns the block."""


class CycleJumpMethod(Protocol):
    """A cycle jump."""

    def __call__(self, start: Situation) -> Block | Trials | None:
        """Return the block that begins here, None where no interface has a rate. Collective."""
