"""What every cycle jump must fulfil, on one interface in series with a spring."""

from dataclasses import replace

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.cycle_jumps.situation import Block
from pearlite_petsc.fatigue.lone_interface import LoneInterface
from pearlite_petsc.laws.damage import RateConstants
from pearlite_petsc.scene import CycleJump, Scene
from pearlite_petsc.studies.law_claims.exact_life import exact_life
from pearlite_petsc.studies.verification.claim import Section

CONSTANTS = RateConstants(np.array([1e-12]), np.array([1000.0]), 0.3)
RATIOS = (0.0, 0.5, 0.8)
"""g of the interfaces in question."""

SMALL, LARGE = 0.01, 0.1
"""Largest increments of a block."""


def cycle_jump_claims(section: Section, scene: Scene) -> None:
    """Add the claims about the cycle jump that a scene has chosen.

    Raises:
        PearliteError: It fails.
    """
    interfaces = [LoneInterface(CONSTANTS, 3000.0, 1500.0, ratio) for ratio in RATIOS]
    small, large = (replace(scene.cycle_jump, delta_d=step) for step in (SMALL, LARGE))
    below = LoneInterface(CONSTANTS, 1000.0, -1000.0, 0.5).blocks(large)
    section.true(
        "Nothing grows at the threshold: no block",
        "Eq. (28)-(31)",
        "arrest",
        "arrest" if not below else f"{len(below)} blocks",
        not below,
    )
    runs = [interface.blocks(large) for interface in interfaces]
    damages = [np.array([0.0, *(float(block.damage[0]) for block in run)]) for run in runs]
    section.true(
        "Blocks take cycles, and damage only grows",
        "dD/dN >= 0",
        "all",
        "all" if (fine := _only_grows(runs, damages)) else "not all",
        fine,
    )
    ends = [bool(damage[-1] == 1.0 and (damage[:-1] < 1.0).all()) for damage in damages]
    section.true(
        "The last block ends exactly where the interface breaks, D = 1",
        "cycle jump",
        f"{len(ends)} interfaces",
        f"{sum(ends)} interfaces",
        all(ends),
    )
    section.below(
        f"Cycles to failure at delta_d = {SMALL:g} against the integral of dD over the rate, g = "
        f"{', '.join(f'{ratio:g}' for ratio in RATIOS)}: largest relative error",
        "one interface in series with a spring",
        max(_error(interface, small) for interface in interfaces),
        0.05,
    )
    worst = max(_error(one, small) - _error(one, large) for one in interfaces)
    section.below(
        f"No larger error at delta_d = {SMALL:g} than at {LARGE:g}: by how much",
        "convergence in the step",
        max(worst, 0.0),
        1e-3,
    )


def _only_grows(runs: list[list[Block]], damages: list[FloatArray]) -> bool:
    cycles = [block.cycles for run in runs for block in run]
    grows = all((np.diff(damage) >= 0.0).all() for damage in damages)
    return grows and all(np.isfinite(value) and value > 0.0 for value in cycles)


def _error(interface: LoneInterface, settings: CycleJump) -> float:
    return abs(interface.life(settings) / exact_life(interface) - 1.0)
