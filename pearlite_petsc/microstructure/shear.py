"""Simple shear of the microstructure and of the lamellae's directions (figure 3 of the source).

``F = [[1, gamma], [0, 1]]`` for A-T, ``[[1, 0], [gamma, 1]]`` for T-A.
"""

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.scene import Orientation


def deformation_gradient(shear_strain: float, orientation: Orientation) -> FloatArray:
    """Return F of a shear strain gamma; (2, 2)."""
    if orientation == "AT":
        return np.array([[1.0, shear_strain], [0.0, 1.0]])
    return np.array([[1.0, 0.0], [shear_strain, 1.0]])


def sheared_angle(angle: FloatArray, deformation: FloatArray) -> FloatArray:
    """Turn directions like material lines; cot(theta) = cot(theta0) + gamma for A-T.

    Args:
        angle: Directions before shear, in [0, pi) [rad]; (n,).
        deformation: F; (2, 2).

    Returns:
        Directions after shear, in [0, pi) [rad]; (n,).
    """
    line = deformation @ np.stack([np.cos(angle), np.sin(angle)])
    turned = np.mod(np.arctan2(line[1], line[0]), np.pi)
    # The modulo of a tiny negative number rounds to pi itself.
    return np.where(turned >= np.pi, 0.0, turned)


def sheared_angle_cdf(
    angle: FloatArray, shear_strain: float, orientation: Orientation
) -> FloatArray:
    """Return the distribution function of directions that were uniform in [0, pi) before shear.

    The direction before shear, as a share of pi counted from the one that becomes 0.

    Args:
        angle: Directions after shear, in [0, pi] [rad]; (n,).
        shear_strain: gamma.
        orientation: Plane of the shear.

    Returns:
        Share of directions below each angle; (n,).
    """
    cos, sin = np.cos(angle), np.sin(angle)
    if orientation == "AT":
        return np.asarray(np.arctan2(sin, cos - shear_strain * sin) / np.pi)
    before = np.arctan2(sin - shear_strain * cos, cos)
    return np.asarray((before + np.arctan(shear_strain)) / np.pi)


def preferred_angle(shear_strain: float, orientation: Orientation) -> float:
    """Return the most frequent direction after shear [rad]: atan2(2, gamma)/2 for A-T.

    >>> round(float(np.degrees(preferred_angle(30.0, "AT"))), 2)
    1.91
    """
    along_x = 0.5 * float(np.arctan2(2.0, shear_strain))
    return along_x if orientation == "AT" else 0.5 * np.pi - along_x


def orientation_order(shear_strain: float) -> float:
    """Return |mean(exp(2 i theta))| after shear: 0 for isotropy, 1 for parallel lamellae.

    >>> [round(orientation_order(gamma), 3) for gamma in (0.0, 2.0, 30.0)]
    [0.0, 0.707, 0.998]
    """
    return shear_strain / float(np.hypot(2.0, shear_strain))
