"""A few interfaces that soften together, for the tests of their jumps and of their course."""

from typing import Any

import numpy as np

from pearlite_petsc.fatigue.softening import FollowingLoad, Softening
from pearlite_petsc.laws import RateConstants

COUNT = 3
RNG = np.random.default_rng(5)
ROOT = RNG.normal(size=(3 * COUNT, 3 * COUNT))
COMPLIANCE = 0.04 * ROOT @ ROOT.T / 9.0 + 0.3 * np.eye(3 * COUNT)
DAMAGE = np.array([0.1, 0.0, 0.3])


def following(
    damage: np.ndarray,
    ratio: float,
    advance: np.ndarray | None = None,
    pull: np.ndarray | None = None,
) -> FollowingLoad:
    """Return a load that follows interfaces of one stiffness ratio, or stays where it is."""
    count = len(damage)
    return FollowingLoad(
        damage,
        np.full(count, ratio),
        np.zeros((count, 2)) if advance is None else advance,
        np.zeros((count, 3, 2)) if pull is None else pull,
    )


def softening(**changes: Any) -> Softening:
    values: dict[str, Any] = {
        "damage": DAMAGE,
        "limit": np.ones(COUNT),
        "jump": np.array([[1.0, 0.2, 0.0], [0.9, -0.3, 0.01], [0.7, 0.1, 0.0]]),
        "constants": np.full((COUNT, 3), 1.2),
        "springs": np.full((COUNT, 2), 1000.0),
        "compliance": COMPLIANCE,
        "rates": RateConstants(np.full(COUNT, 1e-12), np.full(COUNT, 100.0), 0.3),
        "nominal": False,
        "load": following(DAMAGE, 0.4),
    }
    return Softening(**values | changes)


def one_in_series(ratio: float) -> Softening:
    """Return an interface in series with what makes its stiffness ratio g."""
    return softening(
        damage=np.zeros(1),
        limit=np.ones(1),
        jump=np.array([[1.0, 0.0, 0.0]]),
        constants=np.ones((1, 3)),
        springs=np.full((1, 2), 1000.0),
        compliance=ratio * np.eye(3),
        rates=RateConstants(np.array([1e-12]), np.zeros(1), 0.3),
        load=following(np.zeros(1), ratio),
    )
