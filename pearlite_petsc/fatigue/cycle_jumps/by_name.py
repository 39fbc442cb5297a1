"""The cycle jumps that come with the program, by their names in a scene."""

from collections.abc import Callable, Mapping

from pearlite_petsc.fatigue.cycle_jumps.adaptive import Adaptive
from pearlite_petsc.fatigue.cycle_jumps.compliance import Compliance
from pearlite_petsc.fatigue.cycle_jumps.euler import Euler
from pearlite_petsc.fatigue.cycle_jumps.exponential import Exponential
from pearlite_petsc.fatigue.cycle_jumps.heun import Heun
from pearlite_petsc.fatigue.cycle_jumps.situation import CycleJumpMethod
from pearlite_petsc.scene import CycleJump

METHODS: Mapping[str, Callable[[CycleJump], CycleJumpMethod]] = {
    "compliance": lambda settings: Compliance(settings.delta_d),
    "exponential": lambda settings: Exponential(settings.delta_d),
    "euler": lambda settings: Euler(settings.delta_d),
    "heun": lambda settings: Heun(settings.delta_d),
    "adaptive": lambda settings: Adaptive(settings.delta_d, settings.tolerance),
}


def cycle_jump(settings: CycleJump) -> CycleJumpMethod:
    """Return the cycle jump of a scene."""
    return METHODS[settings.method](settings)
