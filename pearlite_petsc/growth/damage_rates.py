"""What the damage law makes of a domain's interfaces while the crack grows."""

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.damage import crack_distance
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.laws.damage import RateConstants
from pearlite_petsc.scene import State


class DamageRates:
    """Rate constants of this rank's interfaces. Collective.

    Args:
        domain: The domain; what is broken there, the notch included, is the crack.
        state: State of the steel.

    Attributes:
        constants: Of the interfaces as the crack is now.
    """

    def __init__(self, domain: Domain, state: State) -> None:
        self._domain, self._state = domain, state
        self._distance: FloatArray | None = None
        if domain.scene.damage.law.follows_crack:
            *_, ends = domain.share_edges(np.flatnonzero(domain.damage >= 1.0))
            self._distance = crack_distance(domain.subdomain.midpoint, ends)
        self.constants: RateConstants = domain.rate_constants(state, self._distance)

    def see_breaks(self, ends: FloatArray) -> None:
        """Take in what has broken.

        Args:
            ends: Both ends of the interfaces that broke, on all ranks [um]; (b, 2, 2).
        """
        if self._distance is None or not len(ends):
            return
        new = crack_distance(self._domain.subdomain.midpoint, ends)
        self._distance = np.minimum(self._distance, new)
        self.constants = self._domain.rate_constants(self._state, self._distance)
