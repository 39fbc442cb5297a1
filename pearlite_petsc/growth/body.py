"""A mesh with its crack: what drives the damage there, and what breaks do to it."""

import numpy as np
from mpi4py import MPI
from scipy.spatial.distance import cdist

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.fatigue.crack import CrackTracker, Point
from pearlite_petsc.fatigue.cycle_jumps.situation import Situation
from pearlite_petsc.fatigue.damage_state import DamageState
from pearlite_petsc.fatigue.loose import LooseClusters
from pearlite_petsc.fatigue.release import released, stiffness_ratio
from pearlite_petsc.growth.case import CrackCase
from pearlite_petsc.growth.coupling import Coupling
from pearlite_petsc.growth.damage_rates import DamageRates
from pearlite_petsc.growth.domain import Domain, Edges
from pearlite_petsc.growth.load import TipLoad, softening_tip
from pearlite_petsc.growth.ranks import on_first_rank
from pearlite_petsc.growth.refinement import notch_tip
from pearlite_petsc.growth.wake import is_near_tip
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.wake import Wake
from pearlite_petsc.tessellation.wake_facets import run_ends

ACTIVE_DAMAGE = 0.05
"""Unbroken interfaces with more damage belong to the crack's front."""


class CrackedBody:
    """A domain with its crack. Collective.

    Attributes:
        domain: The mesh on the ranks; it stays its maker's to close.
        wake: As below.
        tracker: The crack.
        coupling: What couples the interfaces that soften together.

    Args:
        domain: As above.
        case: Load range, state of the steel, damage constants.
        damage: D of this rank's interfaces, read-only from now on; what is broken is the crack; (k,).
        wake: The crack where its elements have coarsened.
    """

    def __init__(
        self, domain: Domain, case: CrackCase, damage: FloatArray, wake: Wake | None = None
    ) -> None:
        self.domain, self.wake, self._case = domain, wake, case
        self._intact: BoolArray = damage < 1.0
        self.tracker = _tracker(domain, ~self._intact, wake)
        whole = domain.gather(damage)
        self._loose = on_first_rank(domain.comm, lambda: _loose(domain, whole))
        self._load = TipLoad(case, domain.subdomain)
        self._loaded: tuple[Point, FloatArray] | None = None
        self._rates = DamageRates(domain, case, ~self._intact)
        interfaces, modulus = domain.subdomain.interfaces, case.scene.material.youngs_modulus
        self._stiffness_ratio = stiffness_ratio(
            interfaces.stiffness.k_n * interfaces.length / modulus
        )
        self.coupling = Coupling(domain, self.tracker, self._load, case.scene.window)

    def situation(self, damage: DamageState) -> Situation:
        """Return what the next block starts from."""
        assert damage.jump is not None
        constants, comm = self._case.scene.damage, self.domain.comm
        nominal = constants.stress == "nominal"
        return Situation(
            damage=damage.damage,
            jump=damage.jump,
            stiffness=self.domain.subdomain.interfaces.stiffness,
            rates=self._rates.constants,
            failure_damage=constants.failure_damage if nominal else 1.0,
            nominal=nominal,
            stiffness_ratio=self._stiffness_ratio,
            coupling=self.coupling,
            memory=damage.memory,
            least=lambda value: float(comm.allreduce(value, MPI.MIN)),
            greatest=lambda value: float(comm.allreduce(value, MPI.MAX)),
        )

    def solve(self, damage: FloatArray) -> FloatArray:
        """Return the jumps of this rank's interfaces in equilibrium [um, um, rad]; (k, 3).

        Args:
            damage: D, of now or on trial; (k,).

        Raises:
            SolverError: No equilibrium was found.
        """
        gone = released(damage, self._stiffness_ratio)
        tip = softening_tip(self.domain, self.tracker, gone, self._intact)
        if self._loaded is None or self._loaded[0] != tip:
            self._loaded = tip, self._load.at(tip)
        equilibrium = self.domain.equilibrium
        equilibrium.update(damage)
        return equilibrium.jumps(equilibrium.solve(self._loaded[1]))

    def reached_by(self, broken: Edges) -> list[Point]:
        """Return the points that the crack would reach if some more interfaces broke [um]."""
        columns = (broken.elements, broken.junctions, broken.ends)
        return self.tracker.reached_after(list(zip(*(c.tolist() for c in columns), strict=True)))

    def check_attached(self, broken: Edges) -> None:
        """Look what would come loose if some more interfaces broke.

        Raises:
            SolverError: A cluster that carries boundary load is cut off.
        """
        on_first_rank(self.domain.comm, lambda: self._clusters.foresee(broken.numbers))

    def lengthen(self, broken: Edges) -> list[Point]:
        """Add broken interfaces to the crack; return the points that it newly reaches [um]."""
        self._intact[self.domain.local(broken)] = False
        self._rates.follow(broken)
        return self.tracker.add(broken.elements, broken.junctions, broken.ends)

    def loosen(self, broken: Edges) -> None:
        """Find what has come loose.

        Raises:
            SolverError: A cluster that carries boundary load is cut off.
        """
        on_first_rank(self.domain.comm, lambda: self._clusters.add(broken.numbers))

    def near(self, broken: Edges) -> BoolArray:
        """Return which of this rank's interfaces feel some breaks much; (k,)."""
        elements = self._case.scene.elements
        reach = 2.0 * max(elements.width, elements.length)
        gap = cdist(self.domain.subdomain.interfaces.midpoint, broken.ends.mean(axis=1))
        return np.asarray(gap.min(axis=1, initial=np.inf) < reach)

    def front(self, damage: FloatArray) -> FloatArray:
        """Return what must lie well inside the fine zone on this rank [um]; (p, 2)."""
        chosen = (damage > ACTIVE_DAMAGE) & (damage < 1.0)
        elements, midpoint = self._case.scene.elements, self.domain.subdomain.interfaces.midpoint
        if elements.wake == "coarse":
            chosen &= is_near_tip(midpoint, self.tracker.tip, elements)
        return np.vstack([midpoint[chosen], self.tracker.tip])

    def loose(self) -> BoolArray | None:
        """Return the elements that hang on no load-bearing interface, None off rank 0; (n,)."""
        return None if self._loose is None else self._loose.loose.copy()

    @property
    def _clusters(self) -> LooseClusters:
        """Loose clusters; rank 0 only."""
        assert self._loose is not None
        return self._loose


def _tracker(domain: Domain, broken: BoolArray, wake: Wake | None) -> CrackTracker:
    """Return the crack of broken interfaces, the notch's first. Collective."""
    tip = None if domain.mesh is None else notch_tip(domain.mesh)
    notch, root = domain.comm.bcast(tip)
    tracker = CrackTracker(notch, root, 0 if wake is None else len(wake.pairs))
    of_notch = domain.subdomain.interfaces.kind == Kind.NOTCH
    if wake is not None:
        ends = None if domain.mesh is None else run_ends(domain.mesh, wake)
        for (start, end), run in zip(domain.comm.bcast(ends), wake.runs, strict=True):
            if start != end:
                tracker.add_run(start, end, run)
        # The facets of the wake are the runs', which know the way better.
        broken = broken & ~(of_notch & _off_notch(domain, notch))
    for notch in (True, False):
        edges = domain.edges(np.flatnonzero(broken & (of_notch == notch)))
        tracker.add(edges.elements, edges.junctions, edges.ends, notch=notch)
    return tracker


def _loose(domain: Domain, damage: FloatArray | None) -> LooseClusters:
    assert domain.mesh is not None and damage is not None
    return LooseClusters(domain.mesh, damage >= 1.0)


def _off_notch(domain: Domain, tip: Point) -> BoolArray:
    """Return the interfaces that are not on the notch's line up to its tip; (k,)."""
    x, y = domain.subdomain.interfaces.ends.reshape(-1, 2, 2).transpose(2, 0, 1)
    return np.asarray((y != tip[1]).any(axis=1) | (x.mean(axis=1) > tip[0]))
