"""Damage of interfaces under cyclic stress, source Eq. (26)-(33), and the damage laws shipped."""

from dataclasses import replace

import numpy as np

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.laws.damage import DamageInterfaces, DamageLaw, RateConstants
from pearlite_petsc.laws.key import LENGTH, number
from pearlite_petsc.mechanics.lefm import TIP_FACTOR
from pearlite_petsc.scene import Damage, Kind, State

_SEGMENTS = 64
_BLEND = 30
_STEEPEST = 0.75 * np.sqrt(3.0)
"""Largest opening stress at one distance from a tip over that straight ahead, at 60 degrees."""


def yield_stress(shear_strain: float) -> float:
    """Return the yield stress of sheared R260 [MPa], Eq. (33): 616 at gamma 2, 1024 at 30.

    This is a power law through those two values; at gamma = 0 it gives 0 while the steel has 470,
    so the yield stress of each state is an input of the program.
    """
    exponent = np.log(1024.0 / 616.0) / np.log(15.0)
    return float(616.0 * (shear_strain / 2.0) ** exponent)


def strength(
    cementite_share: FloatArray, yield_strength: float, cementite_strength: float
) -> FloatArray:
    """Return S of each interface [MPa], the mean over its length.

    A crack passes the parts of an interface one after the other, so that their cycles add up; by
    Eq. (28)-(31) the cycles of a part go with its length and with its S.

    Args:
        cementite_share: Share of the length that cuts cementite; shape (k,).
        yield_strength, cementite_strength: S beside cementite, and across it [MPa].
    """
    return yield_strength + cementite_share * (cementite_strength - yield_strength)


def threshold_stress(interfaces: DamageInterfaces, damage: Damage) -> FloatArray:
    """Return the stress range below which no damage grows [MPa]; (k,).

    ``tip``: b Delta-K_th/sqrt(L), what a crack at Delta-K_th puts on an interface at its tip;
    ``remote``: the remote stress at Delta-K_th.
    """
    if damage.threshold == "tip":
        return np.asarray(TIP_FACTOR * interfaces.delta_k_th / np.sqrt(interfaces.length))
    return np.full(len(interfaces.length), interfaces.remote_threshold)


_THRESHOLD_RATIOS = np.array([0.0, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9])
_STRAIGHT_CRACK_FACTORS = np.array([3.15, 3.07, 3.41, 3.74, 4.24, 4.94, 5.99, 7.02])


def straight_crack_factor(threshold_ratio: FloatArray) -> FloatArray:
    """Return f of da/dN = f (C/S) (b/sqrt(l_ref))^3 (Delta-K - Delta-K_th)^3, law ``objective``.

    f would be 1 if an interface bore b Delta-K/sqrt(L) until it breaks. What is left of a damaged
    interface bears more: 1/(1 - g D) times as much, where g = 1/1.32 is its share of the
    compliance, so f = 4g/(1 - (1 - g)^4) = 3.04 without a threshold; damage further ahead adds 4 %.
    With a threshold the excess grows faster than the stress, and f with it. The values were
    measured on straight cracks in square elements of 3 and 6 um and are the means of both, which
    differ by 0.5 % without a threshold, by 6 % at a ratio of 0.5 and by 15 % at 0.8
    (``pearlite verify --only objectivity``).

    Args:
        threshold_ratio: Delta-K_th/Delta-K; above 0.9 as at 0.9; any shape.

    Example:
        >>> straight_crack_factor(np.array([0.0, 0.5])).tolist()
        [3.15, 3.74]
    """
    return np.asarray(np.interp(threshold_ratio, _THRESHOLD_RATIOS, _STRAIGHT_CRACK_FACTORS))


def printed(interfaces: DamageInterfaces, damage: Damage) -> RateConstants:
    """Return dD/dN = C/(S L) <dsigma - dsigma_th>^3, Eq. (28)-(31)."""
    factor = damage.c / (interfaces.strength * interfaces.length)
    return RateConstants(factor, threshold_stress(interfaces, damage), damage.beta)


def objective(interfaces: DamageInterfaces, damage: Damage) -> RateConstants:
    """Return dD/dN = C/(S l_ref^(3/2) L) <dsigma sqrt(L) - b Delta-K_th>^3.

    It gives da/dN = f (C/S) (b/sqrt(l_ref))^3 (Delta-K - Delta-K_th)^3 for a straight crack, f from
    ``straight_crack_factor``.
    """
    factor = damage.c / (interfaces.strength * interfaces.length)
    factor = factor * (interfaces.length / damage.reference_length) ** 1.5
    return RateConstants(factor, threshold_stress(interfaces, damage), damage.beta)


def rated_length(
    length: FloatArray, crack_distance: FloatArray, critical_distance: float
) -> FloatArray:
    """Return the length l by which an interface is rated [um]: L at the crack, l_0 far from it.

    The K field of a tip puts the mean stress b K/(sqrt(r + L/2) + sqrt(r - L/2)) on an interface
    ahead of it, and at 60 degrees to its sides 1.3 times that, the most at this distance. Rated by
    sqrt(l) = (sqrt(r + L/2) + sqrt(r - L/2))/1.3, none of them is above its threshold at
    Delta-K < Delta-K_th. l is not below L, which it is for those that touch the crack, and held
    below l_0 by (q^-n + a^-n)^(-1/n), n = 30, in place of the smaller of q = l - L and a = l_0 - L.

    Args:
        length: L [um]; shape (k,).
        crack_distance: r of the midpoint [um]; shape (k,).
        critical_distance: l_0 [um].
    """
    half = 0.5 * length
    distance = np.maximum(crack_distance, half)
    field = (np.sqrt(distance + half) + np.sqrt(distance - half)) / _STEEPEST
    way = np.maximum(field**2 - length, 0.0)
    room = np.maximum(critical_distance - length, 0.0)
    least, most = np.minimum(way, room), np.maximum(way, room)
    share = np.divide(least, most, where=most > 0.0, out=np.zeros_like(most))
    return np.asarray(length + least / (1.0 + share**_BLEND) ** (1.0 / _BLEND))


def by_critical_distance(
    interfaces: DamageInterfaces, damage: Damage, *, critical_distance: float
) -> RateConstants:
    """Return ``objective`` with the length l of ``rated_length`` in place of L.

    At the crack it is ``objective``; far away the threshold is the fatigue limit
    b Delta-K_th/sqrt(l_0), 728 MPa at Delta-K_th = 5 MPa sqrt(m) and l_0 = 30 um.
    """
    length = rated_length(interfaces.length, interfaces.crack_distance, critical_distance)
    return objective(replace(interfaces, length=length), damage)


OBJECTIVE = DamageLaw(
    name="objective", help="the same da/dN at any element size", function=objective
)
PRINTED = DamageLaw(name="printed", help="Eq. (28)-(31) as the source has them", function=printed)
CRITICAL_DISTANCE = DamageLaw(
    name="critical_distance",
    help="objective at the crack, a fixed length away from it",
    function=by_critical_distance,
    parameters=(
        number("critical_distance", 30.0, "l_0, which sets the fatigue limit, um", LENGTH, "um"),
    ),
    follows_crack=True,
)
LAWS = (OBJECTIVE, PRINTED, CRITICAL_DISTANCE)
"""The damage laws shipped, the default first."""


def damage_interfaces(
    length: FloatArray,
    kind: IntArray,
    damage: Damage,
    state: State,
    remote_threshold: float,
    midpoint: FloatArray | None = None,
    normal: FloatArray | None = None,
    crack_distance: FloatArray | None = None,
    cementite_share: FloatArray | None = None,
) -> DamageInterfaces:
    """Return interfaces as a damage law sees them.

    Args:
        length: Interface length L [um]; shape (k,).
        kind: Kind of each interface; shape (k,).
        damage: Strength of cementite.
        state: Yield stress and threshold of the state.
        remote_threshold: Remote stress at Delta-K_th [MPa].
        midpoint, normal, crack_distance: See ``DamageInterfaces``; NaN where left out.
        cementite_share: Share of each interface that cuts cementite; shape (k,). Left out, all of
            a ``cementite`` interface and nothing of the others.
    """
    if cementite_share is None:
        cementite_share = (kind == Kind.CEMENTITE).astype(np.float64)
    count = len(length)
    unknown = np.full((count, 2), np.nan)
    return DamageInterfaces(
        length=length,
        kind=kind,
        strength=strength(cementite_share, state.yield_stress, damage.cementite_strength),
        midpoint=unknown if midpoint is None else midpoint,
        normal=unknown if normal is None else normal,
        crack_distance=np.full(count, np.nan) if crack_distance is None else crack_distance,
        delta_k_th=state.delta_k_th,
        remote_threshold=remote_threshold,
    )


def crack_distance(points: FloatArray, broken: FloatArray) -> FloatArray:
    """Return the distance of points from the nearest of some segments [um]; (k,).

    Args:
        points: Midpoints of interfaces [um]; (k, 2).
        broken: Both ends of broken interfaces [um]; (b, 2, 2).
    """
    nearest = np.full(len(points), np.inf)
    for first in range(0, len(broken), _SEGMENTS):
        start, end = np.swapaxes(broken[first : first + _SEGMENTS], 0, 1)
        way_x, way_y = (end - start).T
        x = points[:, None, 0] - start[:, 0]
        y = points[:, None, 1] - start[:, 1]
        square = np.maximum(way_x**2 + way_y**2, np.finfo(float).tiny)
        part = np.clip((x * way_x + y * way_y) / square, 0.0, 1.0)
        distance = np.hypot(x - part * way_x, y - part * way_y)
        nearest = np.minimum(nearest, distance.min(axis=1))
    return nearest
