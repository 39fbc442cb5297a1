"""What every damage law must fulfil."""

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np

from pearlite_petsc.arrays import IntArray
from pearlite_petsc.fatigue.cycle_jumps.shipped import COMPLIANCE, EULER
from pearlite_petsc.fatigue.damage import damage_interfaces
from pearlite_petsc.fatigue.lone_interface import LoneInterface
from pearlite_petsc.laws.damage import DamageInterfaces, RateConstants
from pearlite_petsc.scene import CycleJump, Damage, Kind, Scene, State
from pearlite_petsc.studies.law_claims.exact_life import exact_life
from pearlite_petsc.studies.verification.claim import Section

COUNT = 200
RATIO = 0.7
"""g of the interface whose life is computed."""

STRESSES = np.concatenate([[-1e3, 0.0], np.geomspace(1.0, 1e5, 200)])
"""Stress ranges at which rates are compared [MPa]."""


def interfaces_of(damage: Damage, state: State) -> DamageInterfaces:
    """Return random interfaces of all kinds, lengths from 0.01 to 30 um, at and off the crack."""
    random = np.random.default_rng(7)
    angle = random.uniform(0.0, np.pi, COUNT)
    kinds = [int(kind) for kind in Kind if kind is not Kind.NOTCH]
    return damage_interfaces(
        length=np.geomspace(0.01, 30.0, COUNT),
        kind=random.choice(kinds, COUNT),
        damage=damage,
        state=state,
        remote_threshold=10.0,
        midpoint=random.uniform(0.0, 200.0, (COUNT, 2)),
        normal=np.stack([np.cos(angle), np.sin(angle)], axis=1),
        crack_distance=np.where(np.arange(COUNT) % 4, random.uniform(0.0, 100.0, COUNT), 0.0),
    )


def damage_claims(section: Section, scene: Scene) -> None:
    """Add the claims about the damage law that a scene has chosen.

    Raises:
        PearliteError: The law fails, or returns what no interface can have.
    """
    damage, law = scene.damage, scene.damage.law
    cases = [interfaces_of(damage, state) for state in scene.states]
    found = [law.rate_constants(interfaces, damage) for interfaces in cases]
    section.true(
        f"Factor and threshold of {COUNT} interfaces in each of {len(cases)} states: shape, finite, "
        "not negative",
        "units of the rate: 1/cycle, MPa",
        "all",
        "all",
        True,
    )

    def each(
        statement: str, source: str, holds: Callable[[DamageInterfaces, RateConstants], bool]
    ) -> None:
        wrong = [
            state.name
            for state, interfaces, constants in zip(scene.states, cases, found, strict=True)
            if not holds(interfaces, constants)
        ]
        section.true(statement, source, "every state", _but(wrong), not wrong)

    each(
        "Some interfaces take damage", "a law of growth", lambda _, c: bool((c.factor > 0.0).any())
    )
    each(
        "The same again, and interface by interface in any order, as ranks share them out",
        "results do not depend on the number of ranks",
        lambda i, c: _is_local(i, c, damage),
    )
    each(
        "The rate of some interfaces is that of all: factor, threshold and stress belong together",
        "blocks follow a few interfaces at a time",
        _is_elementwise,
    )
    what = "changes with the distance from the crack" if law.follows_crack else "does not"
    each(
        f"follows_crack = {law.follows_crack}: the law {what}",
        "else it would not be asked again when interfaces break",
        lambda i, c: _depends_on_distance(i, damage) == law.follows_crack,
    )
    each("Nothing up to the threshold, nor under compression", "Eq. (28)-(31)", _is_zero_below)
    each("More stress is never less damage, and always finite", "Eq. (28)-(32)", _is_monotone)
    each(
        "The rate is proportional to C, the threshold independent of it",
        "what calibrate rests on",
        lambda i, c: _scales_with_c(i, c, damage),
    )
    _lives(section, found)


def _but(wrong: list[str]) -> str:
    return f"not {', '.join(wrong)}" if wrong else "every state"


def _taken(interfaces: DamageInterfaces, chosen: IntArray) -> DamageInterfaces:
    arrays = {
        entry.name: getattr(interfaces, entry.name)[chosen]
        for entry in fields(interfaces)
        if isinstance(getattr(interfaces, entry.name), np.ndarray)
    }
    return replace(interfaces, **arrays)


def _is_local(interfaces: DamageInterfaces, known: RateConstants, damage: Damage) -> bool:
    order = np.random.default_rng(3).permutation(COUNT)
    for chosen in (np.arange(COUNT), order, order[: COUNT // 3], order[:1]):
        part = damage.law.rate_constants(_taken(interfaces, chosen), damage)
        if not (
            np.array_equal(part.factor, known.factor[chosen])
            and np.array_equal(part.threshold, known.threshold[chosen])
        ):
            return False
    return True


def _is_elementwise(_: DamageInterfaces, constants: RateConstants) -> bool:
    stress = np.linspace(2.0, 0.0, COUNT) * constants.threshold + 1000.0
    rates = constants.rate(stress, 0.5 * stress)
    for chosen in (np.arange(COUNT)[::-1], np.arange(0, COUNT, 7), np.array([COUNT - 1])):
        some = replace(
            constants, factor=constants.factor[chosen], threshold=constants.threshold[chosen]
        )
        columns = constants.columns(chosen)
        try:
            found = some.rate(stress[chosen], 0.5 * stress[chosen])
            table = columns.rate(stress[chosen, None] * [1.0, 1.0], 0.5 * stress[chosen, None])
        except ValueError:
            return False
        if not np.array_equal(found, rates[chosen]) or table.shape != (len(chosen), 2):
            return False
        if not np.array_equal(table[:, 1], rates[chosen]):
            return False
    return True


def _depends_on_distance(interfaces: DamageInterfaces, damage: Damage) -> bool:
    near, far = (
        damage.law.rate_constants(
            replace(interfaces, crack_distance=factor * interfaces.crack_distance), damage
        )
        for factor in (1.0, 3.0)
    )
    same = np.array_equal(near.factor, far.factor)
    return not (same and np.array_equal(near.threshold, far.threshold))


def _is_zero_below(_: DamageInterfaces, constants: RateConstants) -> bool:
    threshold = constants.threshold
    zero = np.zeros(COUNT)
    return (
        all(
            not constants.rate(normal * threshold, zero).any()
            and not constants.rate(zero, shear * threshold).any()
            for normal, shear in ((1.0, 1.0), (0.5, -1.0), (-1.0, 0.5), (0.0, 0.0))
        )
        and not constants.rate(-10.0 * threshold - 1e4, zero).any()
    )


def _is_monotone(_: DamageInterfaces, constants: RateConstants) -> bool:
    zero = np.zeros(COUNT)
    tension = np.array([constants.rate(np.full(COUNT, value), zero) for value in STRESSES])
    shear = np.array([constants.rate(zero, np.full(COUNT, value)) for value in STRESSES[1:]])
    grows = all((np.diff(rates, axis=0) >= 0.0).all() for rates in (tension, shear))
    return grows and all(np.isfinite(rates).all() for rates in (tension, shear))


def _scales_with_c(interfaces: DamageInterfaces, known: RateConstants, damage: Damage) -> bool:
    double = damage.law.rate_constants(interfaces, replace(damage, c=2.0 * damage.c))
    if not np.allclose(double.threshold, known.threshold, rtol=1e-12, atol=0.0):
        return False
    stress = 3.0 * known.threshold + 1000.0
    rates = [constants.rate(stress, 0.5 * stress) for constants in (known, double)]
    return bool(np.allclose(rates[1], 2.0 * rates[0], rtol=1e-12, atol=0.0))


def _lives(section: Section, found: list[RateConstants]) -> None:
    """Add the claims about one interface's way to failure."""
    plain: list[float] = []
    errors: list[float] = []
    ends: list[bool] = []
    for constants in found:
        damaged = np.flatnonzero(constants.factor > 0.0)
        for number in damaged[:: max(1, len(damaged) // 5)]:
            chosen = slice(number, number + 1)
            one = replace(
                constants,
                factor=constants.factor[chosen],
                threshold=constants.threshold[chosen],
            )
            stress = 2.0 * float(one.threshold[0]) + 1000.0
            constant = LoneInterface(one, stress, 0.0, 0.0)
            life = constant.life(CycleJump(EULER, 1.0, 0.02))
            plain.append(abs(life * constant.rate(0.0) - 1.0))
            softening = LoneInterface(one, stress, 0.5 * stress, RATIO)
            blocks = softening.blocks(CycleJump(COMPLIANCE, 0.25, 0.02))
            damages = [float(block.damage[0]) for block in blocks]
            ends.append(
                bool(damages) and damages[-1] == 1.0 and max(damages[:-1], default=0.0) < 1.0
            )
            jumped = softening.life(CycleJump(COMPLIANCE, 1.0, 0.02))
            errors.append(abs(jumped / exact_life(softening) - 1.0))
    section.below(
        "Constant stress: cycles to failure are 1/rate, relative error",
        "closed form of dD/dN = const",
        max(plain, default=np.inf),
        1e-9,
    )
    section.true(
        "Blocks end exactly where the interface breaks, D = 1",
        "cycle jump",
        f"{len(ends)} interfaces",
        f"{sum(ends)} interfaces",
        bool(ends) and all(ends),
    )
    section.below(
        f"Softening interface, g = {RATIO:g}: cycles to failure in one block against the integral of "
        "dD over the rate, relative error",
        "cycle jump `compliance`",
        max(errors, default=np.inf),
        0.01,
    )
