"""The life of one interface by quadrature."""

from scipy.integrate import quad

from pearlite_petsc.fatigue.lone_interface import LoneInterface


def exact_life(interface: LoneInterface) -> float:
    """Return the cycles to failure, the integral of dD over its rate."""
    life, _ = quad(lambda damage: 1.0 / interface.rate(damage), 0.0, 1.0, epsrel=1e-10, limit=200)
    return float(life)
