"""Spring laws: stiffness per area of the springs spread along an interface (plane stress)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.errors import PearliteError
from pearlite_petsc.laws.law import called, described
from pearlite_petsc.laws.springs import SpringInterfaces, SpringLaw
from pearlite_petsc.scene import Material
from pearlite_petsc.tessellation.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Stiffness:
    """Intact spring stiffnesses.

    Attributes:
        k_n: Normal stiffness per area [MPa/um]; (k,).
        k_t: Tangential stiffness per area [MPa/um]; (k,).
    """

    k_n: FloatArray
    k_t: FloatArray


def equivalent_length(mesh: Mesh) -> FloatArray:
    """Return L_eq, the distance of the two centres projected on the normal [um]; shape (k,)."""
    i, j = mesh.interface_elements.T
    return np.asarray(np.einsum("kd,kd->k", mesh.centre[j] - mesh.centre[i], mesh.normal))


def raje_ratio(poisson_ratio: float) -> float:
    """Return k_t/k_n of the source, (1 - 3 nu)/(1 + nu), Eq. (24)-(25).

    Raises:
        PearliteError: The ratio is not positive (nu >= 1/3).
    """
    ratio = (1.0 - 3.0 * poisson_ratio) / (1.0 + poisson_ratio)
    if not ratio > 0.0:
        raise PearliteError(
            f"springs 'raje': poisson_ratio {poisson_ratio:g} gives k_t/k_n = {ratio:.3g}; Eq. (25) "
            "needs poisson_ratio < 1/3 (use 'homogeneous' or 'matched')"
        )
    return ratio


def homogeneous(interfaces: SpringInterfaces, material: Material) -> Stiffness:
    """Return k_n = k_t = E/L_eq: a homogeneous stress is exact on any Voronoi mesh."""
    k_n = material.youngs_modulus / interfaces.centre_distance
    return Stiffness(k_n, k_n)


def raje(interfaces: SpringInterfaces, material: Material) -> Stiffness:
    """Return k_n = E/((1-nu) L_eq), k_t = E (1-3 nu)/((1-nu^2) L_eq), Eq. (24)-(25), thickness 1.

    Raises:
        PearliteError: nu >= 1/3.
    """
    return matched(interfaces, material, ratio=raje_ratio(material.poisson_ratio))


def matched(interfaces: SpringInterfaces, material: Material, *, ratio: float) -> Stiffness:
    """Return k_n = E/((1-nu) L_eq) and k_t = ratio k_n, the ratio from ``matched_ratio``."""
    distance = interfaces.centre_distance
    k_n = material.youngs_modulus / ((1.0 - material.poisson_ratio) * distance)
    return Stiffness(k_n, ratio * k_n)


def _no_third(material: Material) -> tuple[str, str] | None:
    nu = material.poisson_ratio
    if 1 - 3 * nu > 0:
        return None
    why = "k_t = E (1 - 3 nu) t/((1 - nu^2) L_eq), Eq. (25), is not positive from nu = 1/3 on"
    what = f'= {nu:g} with springs = "raje" is refused: {why}'
    return "poisson_ratio", f'{what}; use springs = "matched" or "homogeneous"'


HOMOGENEOUS = SpringLaw(name="homogeneous", help="E/L_eq", function=homogeneous, poisson_ratio=0.0)
MATCHED = SpringLaw(name="matched", help="meets nu", function=matched, meets_poisson_ratio=True)
RAJE = SpringLaw(name="raje", help="Eq. (24)-(25), nu below 1/3", function=raje, check=_no_third)
LAWS = (HOMOGENEOUS, MATCHED, RAJE)
"""The spring laws shipped, the default first."""


def spring_stiffness(mesh: Mesh, material: Material, ratio: float | None = None) -> Stiffness:
    """Return the springs of each interface, the notch's included (callers break those).

    Args:
        mesh: The mesh.
        material: Elastic constants and spring law.
        ratio: k_t/k_n, for laws that meet the Poisson ratio.

    Raises:
        PearliteError: Centres out of order along a normal, no ratio, or a law that fails or
            returns what is no stiffness.
    """
    distance = equivalent_length(mesh)
    if not np.all(distance > 0.0):
        worst = int(np.argmin(distance))
        raise PearliteError(
            f"interface {worst}: centre distance {distance[worst]:g} um is not positive"
        )
    interfaces = SpringInterfaces(distance, mesh.length, mesh.kind, mesh.midpoint, mesh.normal)
    return stiffness_of(interfaces, material, ratio)


def stiffness_of(
    interfaces: SpringInterfaces, material: Material, ratio: float | None = None
) -> Stiffness:
    """Return the springs of some interfaces by the material's law.

    Args:
        interfaces: k interfaces.
        material: Elastic constants and spring law.
        ratio: k_t/k_n, for laws that meet the Poisson ratio.

    Raises:
        PearliteError: No ratio, or a law that fails or returns what is no stiffness.
    """
    law = material.springs
    more = {}
    if law.meets_poisson_ratio:
        if ratio is None:
            raise PearliteError(f"springs '{law.name}': the ratio k_t/k_n of the mesh is missing")
        more["ratio"] = ratio
    return _checked(law, called(law, interfaces, material, **more), len(interfaces.length))


def _checked(law: SpringLaw, found: object, count: int) -> Stiffness:
    """Return what a law has made of some interfaces.

    Raises:
        PearliteError: It is no stiffness of each, finite and positive.
    """
    if not isinstance(found, Stiffness):
        raise PearliteError(f"{described(law)} returns {type(found).__name__}, not Stiffness")
    for name, values in (("k_n", found.k_n), ("k_t", found.k_t)):
        if np.shape(values) != (count,):
            shapes = f"shape {np.shape(values)}, not {(count,)}"
            raise PearliteError(f"{described(law)}: {name} has {shapes}")
        wrong = np.flatnonzero(~(np.isfinite(values) & (values > 0.0)))
        if len(wrong):
            first = f"interface {wrong[0]}: {name} {values[wrong[0]]:g} MPa/um"
            raise PearliteError(f"{described(law)}: {first} is not finite and positive")
    return found


def matched_ratio(poisson_of_ratio: Callable[[float], float], poisson_ratio: float) -> float:
    """Return k_t/k_n for which a mesh shows the wanted Poisson ratio.

    Args:
        poisson_of_ratio: Poisson ratio of the mesh as a falling function of k_t/k_n.
        poisson_ratio: The ratio to meet.

    Raises:
        PearliteError: No ratio between 0.01 and 4 meets it.
    """
    low, high = 0.01, 4.0
    ends = poisson_of_ratio(low) - poisson_ratio, poisson_of_ratio(high) - poisson_ratio
    if not ends[0] > 0.0 > ends[1]:
        raise PearliteError(
            f"springs 'matched': this mesh reaches Poisson ratios from {ends[1] + poisson_ratio:.3f} "
            f"to {ends[0] + poisson_ratio:.3f}, not {poisson_ratio:g}"
        )
    return float(
        brentq(lambda ratio: poisson_of_ratio(ratio) - poisson_ratio, low, high, xtol=1e-6)
    )
