"""Where the load is centred while an interface that will lengthen the crack softens."""

import numpy as np

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.fatigue.crack import CrackTracker, Point
from pearlite_petsc.fatigue.softening import SOFTENING
from pearlite_petsc.growth.domain import Domain


def softening_tip(domain: Domain, tracker: CrackTracker, released: FloatArray) -> Point:
    """Return the crack's tip on its way to where the softening interface will take it [um].

    It moves with the share of the force that the interface has let go, so that the load is steady
    where the interface breaks. A load centred on the tip of before would raise K by 2 % a um until
    then (window 200 um), and da/dN with the size of the elements. Collective.

    Args:
        domain: The mesh; what is broken there belongs to the crack.
        tracker: The crack.
        released: Share of its force that each interface has let go, 1 where broken, by itself or on
            trial; (k,).
    """
    subdomain, tip = domain.subdomain, tracker.tip
    candidates = np.flatnonzero(
        (released > SOFTENING) & (domain.damage < 1.0) & subdomain.owns_interface
    )
    best: tuple[float, int, Point] = (0.0, 0, tip)
    pairs = subdomain.element_numbers[subdomain.interface_elements[candidates]].tolist()
    junctions, ends = subdomain.junctions[candidates].tolist(), subdomain.ends[candidates].tolist()
    interfaces = zip(pairs, junctions, ends, strict=True)
    for number, interface in zip(candidates.tolist(), interfaces, strict=True):
        x, y = tracker.tip_after(interface)
        share = float(released[number])
        gain = share * (x - tip[0])
        point = tip[0] + gain, tip[1] + share * (y - tip[1])
        best = max(best, (gain, -int(subdomain.interface_numbers[number]), point))
    best = max(domain.comm.allgather(best))
    return best[2]
