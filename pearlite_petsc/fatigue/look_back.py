"""Second look at a block of cycles once the solve after it shows where the stresses went.

While one interface softens, the body outside it is linear in the force that it still carries.
Between the solves before and after a block every stress therefore moves along one curve, the
share phi of the leading interface's force released so far,

    phi(D) = 1 - (1 - D)/(1 - g D) up to scale,

which is exact where one interface softens alone. The end point needs no solve of its own: it is
the one that the next block starts from. With it the block's cycles and the damage of all other
interfaces are integrated again.
"""

from dataclasses import dataclass

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.cycle_jump import LARGEST_SHARE, Drive, released

_NODES = 25
_PASSIVE = 1e-5


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """How a block went for its leading interface.

    Attributes:
        cycles: Since the block's start, ascending from 0 [cycles]; (m,).
        released: Share of the stress change that was there by then, 0 to 1; (m,).
    """

    cycles: FloatArray
    released: FloatArray


def leading_share(before: float, after: float, damage: float, damage_end: float) -> float:
    """Return g of the leading interface from its effective stress before and after the block.

    ``after/before = (1 - g D_0)/(1 - g D_1)``, kept within [0, 0.95].

    Args:
        before, after: Stress magnitudes k_0 jump [MPa], > 0.
        damage, damage_end: D_0 and D_1.
    """
    ratio = after / before
    divisor = ratio * damage_end - damage
    return float(np.clip((ratio - 1.0) / divisor if divisor > 0.0 else 0.0, 0.0, LARGEST_SHARE))


def course_of(leading: Drive, share: float, damage_end: float) -> Course:
    """Return the course of a block whose leading interface went from its damage to an end.

    Args:
        leading: Drive of the one interface, as ``Drive.take`` gives it; arrays of shape (1, 1).
        share: Its g.
        damage_end: Its damage at the end.
    """
    start = float(leading.damage[0, 0])
    # Dense at the end, where the force goes, and at the start, where close above the threshold the
    # cycles go.
    grading = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, _NODES))
    damage = start + (damage_end - start) * grading
    drive = leading.with_sensitivity(np.full((1, 1), share))
    slowness = 1.0 / drive.rate_along(damage[None, :], "compliance")[0]
    mean = 0.5 * (slowness[1:] + slowness[:-1]) * np.diff(damage)
    force = released(damage, np.asarray(share))
    part = (force - force[0]) / (force[-1] - force[0])
    return Course(np.concatenate([[0.0], np.cumsum(mean)]), part)


def damage_after(
    drive: Drive, normal_end: FloatArray, shear_end: FloatArray, course: Course
) -> FloatArray:
    """Return the damage at the block's end, from the stresses at its start and its end.

    Args:
        drive: Damage and stresses at the start.
        normal_end, shear_end: Effective stresses at the end [MPa]; (k,).
        course: Of the leading interface.

    Returns:
        D, not yet limited to the failure damage; (k,).
    """
    at_end = Drive(
        drive.damage, normal_end, shear_end, drive.law, drive.failure_damage, drive.nominal
    )
    most = np.maximum(drive.rate_at(drive.damage), at_end.rate_at(drive.damage))
    active: IntArray = np.flatnonzero(most * course.cycles[-1] > _PASSIVE)
    path = drive.take(active)
    part = course.released
    normal = path.normal + (normal_end[active, None] - path.normal) * part
    shear = path.shear + (shear_end[active, None] - path.shear) * part
    blend = Drive(path.damage, normal, shear, path.law, drive.failure_damage, drive.nominal)
    rate = blend.rate_at(path.damage)
    damage = drive.damage.copy()
    # Not a matrix product: its rounding depends on the number of rows, so that two ranks would
    # not agree on an interface that both hold.
    mean = 0.5 * (rate[:, 1:] + rate[:, :-1])
    damage[active] += (mean * np.diff(course.cycles)).sum(axis=1)
    return damage
