"""Damage of all that hardly softens in a block, once the solve at its end shows the stresses there.

The body outside the softening interfaces is linear in the force that they let go. Between the
solves before and after a block the stress of every other interface therefore moves with the
fraction of that force that is gone, and its damage is the integral of the rates on the way.
"""

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.fatigue.course import Course
from pearlite_petsc.fatigue.drive import Drive

_PASSIVE = 1e-5


def damage_at_end(
    drive: Drive, normal_end: FloatArray, shear_end: FloatArray, course: Course
) -> FloatArray:
    """Return the damage at the block's end, from the stresses at its start and its end.

    Args:
        drive: Damage and stresses at the start.
        normal_end, shear_end: Effective stresses at the end [MPa]; (k,).
        course: Of the softening interfaces.

    Returns:
        D, not yet limited to the failure damage; (k,).
    """
    at_end = Drive(
        drive.damage, normal_end, shear_end, drive.rates, drive.failure_damage, drive.nominal
    )
    most = np.maximum(drive.rate_at(drive.damage), at_end.rate_at(drive.damage))
    active: IntArray = np.flatnonzero(most * course.cycles[-1] > _PASSIVE)
    path = drive.of(active)
    normal = path.normal + (normal_end[active, None] - path.normal) * course.released
    shear = path.shear + (shear_end[active, None] - path.shear) * course.released
    blend = Drive(path.damage, normal, shear, path.rates, drive.failure_damage, drive.nominal)
    rate = blend.rate_at(path.damage)
    damage = drive.damage.copy()
    # Not a matrix product: its rounding depends on the number of rows, so that two ranks would
    # not agree on an interface that both hold.
    mean = 0.5 * (rate[:, 1:] + rate[:, :-1])
    damage[active] += (mean * np.diff(course.cycles)).sum(axis=1)
    return damage
