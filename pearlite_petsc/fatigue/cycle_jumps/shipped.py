"""The cycle jumps that come with the program."""

from pearlite_petsc.fatigue.cycle_jumps.adaptive import Adaptive
from pearlite_petsc.fatigue.cycle_jumps.compliance import Compliance
from pearlite_petsc.fatigue.cycle_jumps.euler import Euler
from pearlite_petsc.fatigue.cycle_jumps.exponential import Exponential
from pearlite_petsc.fatigue.cycle_jumps.heun import Heun
from pearlite_petsc.laws.cycle_jump import CycleJumpLaw

COMPLIANCE = CycleJumpLaw(
    name="compliance",
    help="interfaces soften together",
    function=lambda start, settings: Compliance(settings.delta_d)(start),
)
EXPONENTIAL = CycleJumpLaw(
    name="exponential",
    help="rates grow with the damage",
    function=lambda start, settings: Exponential(settings.delta_d)(start),
)
EULER = CycleJumpLaw(
    name="euler",
    help="the source",
    function=lambda start, settings: Euler(settings.delta_d)(start),
)
HEUN = CycleJumpLaw(
    name="heun",
    help="mean of the rates at both ends",
    function=lambda start, settings: Heun(settings.delta_d)(start),
)
ADAPTIVE = CycleJumpLaw(
    name="adaptive",
    help="like compliance, to a tolerance",
    function=lambda start, settings: Adaptive(settings.delta_d, settings.tolerance)(start),
)
LAWS = (COMPLIANCE, EXPONENTIAL, EULER, HEUN, ADAPTIVE)
"""The cycle jumps shipped, the default first."""
