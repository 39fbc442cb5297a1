"""The load range on the window, which follows the tip of the crack."""

import numpy as np

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.fatigue.crack import CrackTracker, Point
from pearlite_petsc.fatigue.softening import SOFTENING
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.domain import Domain
from pearlite_petsc.mechanics.lefm import remote_stress
from pearlite_petsc.mechanics.loads import element_forces, uniform_stress, williams_mode_one
from pearlite_petsc.solver.subdomain import Subdomain


class TipLoad:
    """The load on a rank's owned elements for a crack's tip.

    Args:
        case: Load range, window.
        subdomain: The rank's.
    """

    def __init__(self, case: CrackCase, subdomain: Subdomain) -> None:
        self._case, self._subdomain = case, subdomain

    def at(self, tip: Point) -> FloatArray:
        """Return (F_x, F_y, M) on owned elements [uN, uN, uN um]; (owned, 3).

        Args:
            tip: Where the load is centred [um].
        """
        subdomain, delta_k, scene = self._subdomain, self._case.delta_k, self._case.scene
        if scene.loading.kind == "k_field":
            airy = williams_mode_one(delta_k, tip)
        else:
            length = scene.window.notch if scene.loading.control == "stress" else tip[0]
            airy = uniform_stress(0.0, remote_stress(delta_k, length, scene.window.width), 0.0)
        owned, boundary = subdomain.centre[: subdomain.owned_count], subdomain.boundary
        return element_forces(
            boundary.facet_start, boundary.facet_end, boundary.elements, owned, airy
        )


def softening_tip(
    domain: Domain, tracker: CrackTracker, released: FloatArray, intact: BoolArray
) -> Point:
    """Return the crack's tip on its way to where the softening interface will take it [um].

    It moves with the fraction of the force that the interface has let go, so that the load is steady
    where the interface breaks. A load centred on the tip of before would raise K by 2 % a um until
    then (window 200 um), and da/dN with the size of the elements. Collective.

    Args:
        domain: The mesh.
        tracker: The crack.
        released: Fraction of its force that each interface has let go, 1 where broken, by itself or
            on trial; (k,).
        intact: Whether an interface is not part of the crack; (k,).
    """
    subdomain, own, tip = domain.subdomain, domain.subdomain.interfaces, tracker.tip
    candidates = np.flatnonzero((released > SOFTENING) & intact & subdomain.owns_interface)
    best: tuple[float, int, Point] = (0.0, 0, tip)
    pairs = subdomain.element_numbers[own.elements[candidates]].tolist()
    junctions, ends = own.junctions[candidates].tolist(), own.ends[candidates].tolist()
    interfaces = zip(pairs, junctions, ends, strict=True)
    for number, interface in zip(candidates.tolist(), interfaces, strict=True):
        x, y = tracker.tip_after(interface)
        gone = float(released[number])
        gain = gone * (x - tip[0])
        point = tip[0] + gain, tip[1] + gone * (y - tip[1])
        best = max(best, (gain, -int(own.numbers[number]), point))
    best = max(domain.comm.allgather(best))
    return best[2]
