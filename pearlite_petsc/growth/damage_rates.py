"""What the damage law makes of a domain's interfaces while the crack grows."""

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.fatigue.damage import crack_distance, damage_interfaces
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.domain import Domain, Edges
from pearlite_petsc.laws.damage import RateConstants
from pearlite_petsc.mechanics.lefm import remote_stress
from pearlite_petsc.solver.subdomain import SubdomainInterfaces


class DamageRates:
    """Rate constants of this rank's interfaces. Collective.

    Args:
        domain: The mesh.
        case: Damage law, state of the steel.
        broken: Which of this rank's interfaces are the crack, the notch included; (k,).

    Attributes:
        constants: Of the interfaces as the crack is now.
    """

    def __init__(self, domain: Domain, case: CrackCase, broken: BoolArray) -> None:
        self._interfaces, self._case = domain.subdomain.interfaces, case
        self._distance: FloatArray | None = None
        if case.scene.damage.law.follows_crack:
            ends = domain.edges(np.flatnonzero(broken)).ends
            self._distance = crack_distance(self._interfaces.midpoint, ends)
        self.constants: RateConstants = rate_constants(self._interfaces, case, self._distance)

    def follow(self, broken: Edges) -> None:
        """Take interfaces into the crack."""
        if self._distance is None or not len(broken.numbers):
            return
        new = crack_distance(self._interfaces.midpoint, broken.ends)
        self._distance = np.minimum(self._distance, new)
        self.constants = rate_constants(self._interfaces, self._case, self._distance)


def rate_constants(
    interfaces: SubdomainInterfaces, case: CrackCase, distance: FloatArray | None
) -> RateConstants:
    """Return what the damage law makes of a rank's interfaces.

    Coarse elements carry the load to the fine ones and take no damage: their long interfaces would
    pass a threshold that falls with 1/sqrt(L) far from any crack.

    Args:
        interfaces: The rank's.
        case: Damage law, state of the steel.
        distance: Of each interface from the crack [um]; (k,), None where the law does not follow
            the crack.
    """
    window, damage = case.scene.window, case.scene.damage
    given = damage_interfaces(
        interfaces.length,
        interfaces.kind,
        damage,
        case.state,
        remote_stress(case.state.delta_k_th, window.notch, window.width),
        interfaces.midpoint,
        interfaces.normal,
        distance,
        interfaces.cementite_share,
    )
    return damage.law.rate_constants(given, damage).only(interfaces.fine)
