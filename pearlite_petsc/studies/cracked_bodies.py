"""Bodies with straight cracks whose stress intensity the handbooks give."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from scipy.integrate import quad

from pearlite_petsc.arrays import BoolArray, FloatArray
from pearlite_petsc.mechanics.lefm import centre_crack_factor, edge_crack_factor
from pearlite_petsc.mechanics.loads import uniform_stress
from pearlite_petsc.mechanics.springs import spring_stiffness
from pearlite_petsc.mechanics.statics import load_vector
from pearlite_petsc.scene import Solver
from pearlite_petsc.solver.equilibrium import Equilibrium
from pearlite_petsc.solver.subdomain import subdomain_of
from pearlite_petsc.studies.bodies import on_line, plain_mesh, tensor_points
from pearlite_petsc.studies.cases import STEEL
from pearlite_petsc.tessellation.mesh import Mesh

BASE = 8.0
"""Element width of the coarsest grid at the crack's line [um]; finer grids halve every cell."""

_LAYERS = np.array([8.0] * 6 + [12.0, 16.0, 24.0, 32.0, 40.0, 56.0, 72.0])
LAYERS, HALF_HEIGHT = len(_LAYERS), float(_LAYERS.sum())


@dataclass(frozen=True, slots=True)
class CrackedBody:
    """A strip in tension along y with a crack at half height.

    Attributes:
        name: For tables.
        width: Of the strip [um].
        centre: Whether the crack lies in the middle (half length a) or enters from the left.
        reference: Accurate F at a/W beside the handbook's formula, None if that is accurate enough.
        before, after: a between which the energy release is taken [um].
    """

    name: str
    width: float
    centre: bool
    reference: float | None
    before: float
    after: float

    @property
    def ratio(self) -> float:
        """a/W in the middle of the advance, W half the width for a centre crack."""
        return 0.5 * (self.before + self.after) / (self.width * (0.5 if self.centre else 1.0))

    def ends(self, a: float) -> tuple[float, float]:
        """Return the x between which the body is cracked [um]."""
        middle = 0.5 * self.width
        return (middle - a, middle + a) if self.centre else (0.0, a)

    def handbook_release(self) -> float:
        """Return the integral of K^2/E' over the advance for unit stress [uN um], by Tada's F."""
        factor: Callable[[float], float] = centre_crack_factor if self.centre else edge_crack_factor
        half = self.width * (0.5 if self.centre else 1.0)

        def rate(a: float) -> float:
            return factor(a / half) ** 2 * np.pi * a / STEEL.youngs_modulus

        tips = 2.0 if self.centre else 1.0
        return tips * float(quad(rate, self.before, self.after)[0])

    def over_reference(self, over_handbook: float) -> float:
        """Return K over the accurate value from K over the handbook's."""
        if self.reference is None:
            return over_handbook
        return over_handbook * edge_crack_factor(self.ratio) / self.reference


EDGE = (
    CrackedBody("edge a/W 0.2", 200.0, False, 1.3673, 32.0, 48.0),
    CrackedBody("edge a/W 0.3", 200.0, False, 1.6599, 56.0, 64.0),
    CrackedBody("edge a/W 0.5", 200.0, False, 2.8246, 96.0, 104.0),
)
"""F of Kaya and Erdogan 1987 beside Tada's formula, which is good to 0.5 %."""

CENTRE = (
    CrackedBody("centre a/W 0.25", 192.0, True, None, 16.0, 32.0),
    CrackedBody("centre a/W 0.5", 192.0, True, None, 40.0, 56.0),
)


def layers(pieces: int) -> FloatArray:
    """Return y of the grid's lines above the crack, that many pieces an element of the base [um]."""
    lines = np.concatenate([[0.0], np.cumsum(_LAYERS)])
    return np.interp(np.linspace(0.0, LAYERS, pieces + 1), np.arange(len(lines)), lines)


def grid_mesh(width: float, element: float) -> Mesh:
    """Return the strip in square cells at the crack's line, flat ones far away.

    Args:
        width: Of the strip [um].
        element: Width of the cells [um]; ``BASE`` over a whole number.
    """
    upper = layers(round(LAYERS * BASE / element))
    y = HALF_HEIGHT + np.concatenate([-upper[:0:-1], upper])
    x = np.linspace(0.0, width, round(width / element) + 1)
    return plain_mesh(tensor_points(x, y), width, 2.0 * HALF_HEIGHT)


def grid_ratios(bodies: tuple[CrackedBody, ...], element: float) -> tuple[int, list[float]]:
    """Return unknowns and K over the handbook's of each body (all of one width) on the grid."""
    mesh = grid_mesh(bodies[0].width, element)
    cracks = [
        on_line(mesh, HALF_HEIGHT, *body.ends(a))
        for body in bodies
        for a in (body.before, body.after)
    ]
    energy = energies(mesh, cracks)
    releases = np.diff(energy)[::2]
    ratios = [
        float(np.sqrt(release / body.handbook_release()))
        for body, release in zip(bodies, releases, strict=True)
    ]
    return 3 * mesh.element_count, ratios


def energies(mesh: Mesh, cracks: list[BoolArray]) -> FloatArray:
    """Return the elastic energy under unit stress along y for each set of broken interfaces."""
    subdomain = subdomain_of(mesh, spring_stiffness(mesh, STEEL), 0, mesh.element_count)
    load = load_vector(mesh, uniform_stress(0.0, 1.0, 0.0))
    forces = load * [1.0, 1.0, subdomain.rotation_length]
    energy = []
    settings = Solver("iterative", 1e-7, 1)
    with Equilibrium(MPI.COMM_SELF, subdomain, cracks[0].astype(float), settings) as equilibrium:
        for broken in cracks:
            equilibrium.update(broken.astype(float))
            # The energy's error is the square of the residual's.
            energy.append(0.5 * float((load * equilibrium.solve(forces)).sum()))
    return np.array(energy)
