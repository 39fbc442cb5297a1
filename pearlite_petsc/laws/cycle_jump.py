"""Cycle jumps as plug-ins."""

from dataclasses import dataclass
from typing import ClassVar

from pearlite_petsc.laws.law import Law


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleJumpLaw(Law):
    """A cycle jump: ``function(start, settings, *, parameters...) -> Block | Trials | None``.

    The function gets the ``Situation`` at the start of a block and the scene's ``CycleJump``
    table; ``fatigue.cycle_jumps.situation`` explains what it may ask for and what it returns.
    """

    table: ClassVar[str] = "cycle_jump"
    key: ClassVar[str] = "method"
    arguments: ClassVar[tuple[str, ...]] = ("start", "settings")
