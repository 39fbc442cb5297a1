"""The damage of one interface against an ODE solver, and what converges in the step and what not."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.ticker import NullFormatter

from pearlite_petsc.fatigue.extrapolation import Extrapolation, RateModel
from pearlite_petsc.output.figures.style import drawing
from pearlite_petsc.scene import Kind
from pearlite_petsc.studies.cases import DAMAGE
from pearlite_petsc.studies.verification.claim import Section, Setting, fitted_order
from pearlite_petsc.studies.verification.series_spring import (
    STEEL_STATE,
    THRESHOLD,
    SeriesSpring,
)

LAW = "Eq. (26)-(32), ODE solver DOP853 at 1e-10"
STEPS = (0.2, 0.1, 0.05, 0.02)
METHODS: tuple[RateModel, ...] = ("euler", "exponential", "compliance")
ORDERS: dict[RateModel, float] = {"euler": 1.0, "exponential": 2.0}
CASES = {
    "effective, lamella": SeriesSpring(6e3, 2e3, 0.7),
    "effective, cementite": SeriesSpring(6e3, 7e3, 0.5, Kind.CEMENTITE),
    "nominal to D_c = 0.5, lamella": SeriesSpring(6e3, 2e3, 0.7, nominal=True, failure=0.5),
    "nominal to D_c = 0.5, cementite": SeriesSpring(
        6e3, 7e3, 0.5, Kind.CEMENTITE, nominal=True, failure=0.5
    ),
}


def damage(setting: Setting) -> Section:
    """Return the claims about the damage of one interface in series with a spring."""
    section = Section("Damage: one interface in series with a spring")
    free = replace(STEEL_STATE, delta_k_th=0.0)
    plain = SeriesSpring(6e3, 0.0, 0.7, state=free)
    section.below(
        "The ODE solver against the closed form (1 - (1 - g)^4)/(4 g rate_0), no threshold",
        "Eq. (28) with stress 1/(1 - g D)",
        abs(plain.exact_life() / closed_form(plain) - 1.0),
        1e-10,
    )
    _known_ratio(section)
    errors = _orders(section)
    _threshold(section)
    _strength(section)
    lives = _nominal(section)
    _draw(setting.folder / "damage_step", errors["effective, lamella"], lives)
    section.figures["damage_step"] = (
        "Left: error of the life of one interface (effective stress) over the step. Right: life with "
        "the nominal stress over that with a step of 0.2; it has no limit."
    )
    return section


def closed_form(case: SeriesSpring) -> float:
    """Return the life under a normal stress without threshold [cycles]."""
    return (1.0 - (1.0 - case.stiffness_ratio) ** 4) / (4.0 * case.stiffness_ratio * case.rate(0.0))


def _known_ratio(section: Section) -> None:
    case = CASES["effective, lamella"]
    block = Extrapolation(case.with_known_ratio(), 1.0, "compliance")
    life = case.exact_life()
    section.below(
        "Compliance curve with g known (table of 33 nodes), one block to failure: error of the life",
        LAW,
        abs(block.longest / life - 1.0),
        2e-3,
    )
    worst = max(
        abs(float(block.damage_after(part * block.longest)[0]) - case.exact_damage(part * life))
        for part in (0.1, 0.5, 0.9)
    )
    section.below("The same: largest error of D on the way", LAW, worst, 2e-3)


def _orders(section: Section) -> dict[str, dict[RateModel, list[float]]]:
    """Claim orders and errors of the life; return the errors by case, method and step."""
    errors = {
        name: {
            method: [
                abs(case.jumped_life(method, step) / case.exact_life() - 1.0) for step in STEPS
            ]
            for method in METHODS
        }
        for name, case in CASES.items()
    }
    for name, by_method in errors.items():
        for method, order in ORDERS.items():
            fitted = fitted_order(list(STEPS), by_method[method])
            statement = f"{name}, {method}: order of the life's error in the step"
            section.close(statement, LAW, order, fitted, 0.3)
        section.below(
            f"{name}, compliance, step {STEPS[-1]:g}: error of the life",
            LAW,
            by_method["compliance"][-1],
            2e-5,
        )
    section.text.append("Error of the life over the largest damage increment of a block:")
    section.table(
        ["case", "method", *(f"{step:g}" for step in STEPS)],
        [
            [name, method, *(f"{error:.1e}" for error in found)]
            for name, by_method in errors.items()
            for method, found in by_method.items()
        ],
    )
    for name, case in CASES.items():
        section.below(
            f"{name}, compliance, one block to failure: error of the life",
            LAW,
            abs(case.jumped_life("compliance", 1.0) / case.exact_life() - 1.0),
            0.01,
        )
    return errors


def _threshold(section: Section) -> None:
    for kind in (Kind.LAMELLA, Kind.CEMENTITE):
        for place, level in (("at", 1.0), ("below", 0.99)):
            lives = [
                SeriesSpring(level * THRESHOLD, 0.0, 0.7, kind, nominal).jumped_life(method, 0.1)
                for method in METHODS
                for nominal in (False, True)
            ]
            section.true(
                f"Nothing grows {place} the threshold, {kind.name.lower()}, all methods",
                "Eq. (28)-(31), <.> the positive part",
                "infinite",
                ", ".join(sorted({f"{life:g}" for life in lives})),
                bool(np.isinf(lives).all()),
            )
    above = SeriesSpring(1.05 * THRESHOLD, 0.0, 0.7)
    life = above.exact_life()
    section.close(
        "5 % above the threshold, compliance, one block to failure: life",
        LAW,
        1.0,
        above.jumped_life("compliance", 1.0) / life,
        0.05,
    )
    section.text.append(
        "Limit: close above the threshold most of the life passes at almost no damage, where the "
        "table of a block is coarse. At 5 % above it the life is off by "
        + ", ".join(
            f"{above.jumped_life('compliance', step) / life - 1.0:+.1%} at a step of {step:g}"
            for step in (1.0, 0.5, 0.2)
        )
        + "."
    )


def _strength(section: Section) -> None:
    lives = [
        SeriesSpring(6e3, 2e3, 0.7, kind).jumped_life("compliance", 1.0)
        for kind in (Kind.LAMELLA, Kind.CEMENTITE)
    ]
    expected = DAMAGE.cementite_strength / STEEL_STATE.yield_stress
    section.close(
        "Cementite lives longer by the ratio of strengths",
        "Eq. (28)-(31)",
        expected,
        lives[1] / lives[0],
        1e-9 * expected,
    )
    shear = SeriesSpring(0.0, 6e3, 0.7).exact_life()
    back = SeriesSpring(-6e3, -6e3, 0.7)
    section.close(
        "Compression adds nothing and the sign of the shear does not count: ratio of rates",
        "Eq. (28)-(32)",
        1.0,
        SeriesSpring(0.0, 6e3, 0.7).jumped_life("euler", 0.1) / back.jumped_life("euler", 0.1),
        1e-12,
    )
    normal = SeriesSpring(6e3, 0.0, 0.7).exact_life()
    section.close(
        "Shear alone against tension alone: ratio of rates is sqrt(beta)",
        "Eq. (32)",
        float(np.sqrt(DAMAGE.beta)),
        normal / shear,
        1e-9,
    )


def _nominal(section: Section) -> dict[str, list[float]]:
    free = replace(STEEL_STATE, delta_k_th=0.0)
    lives = {}
    for ratio in (0.0, 0.7):
        case = SeriesSpring(6e3, 0.0, ratio, nominal=True, state=free)
        lives[f"g = {ratio:g}"] = [case.jumped_life("euler", step) for step in STEPS]
    growth = {name: -fitted_order(list(STEPS), found) for name, found in lives.items()}
    section.above(
        "Nominal stress, no threshold: the life grows without limit as step^-p (source's blocks), "
        "p for g = 0",
        "Eq. (26)-(28); N to failure is the integral of (1 - D)^-3",
        growth["g = 0"],
        1.5,
    )
    with_threshold = [
        SeriesSpring(6e3, 0.0, 0.7, nominal=True).jumped_life("euler", step) for step in STEPS
    ]
    section.true(
        "Nominal stress under a threshold: the source's blocks fail at a step of 0.2, never at 0.1",
        "Eq. (26)-(31)",
        "finite, then infinite",
        ", ".join(f"{life:.4g}" for life in with_threshold),
        bool(np.isfinite(with_threshold[0]) and np.isinf(with_threshold[1:]).all()),
    )
    section.text.append(
        "Life with the nominal stress to D = 1 and Euler's blocks, over the step: "
        + "; ".join(
            f"{name}: " + ", ".join(f"{life:.3g}" for life in found)
            for name, found in lives.items()
        )
        + f" (exponent {growth['g = 0']:.2f} and {growth['g = 0.7']:.2f}). The effective stress, the "
        "default, has none of this."
    )
    return lives


def _draw(path: Path, errors: dict[RateModel, list[float]], lives: dict[str, list[float]]) -> None:
    with drawing(path, height=3.0) as figure:
        left, right = figure.subplots(1, 2)
        for method, found in errors.items():
            left.loglog(STEPS, 100.0 * np.array(found), "o-", label=method)
        left.set(xlabel="largest damage increment of a block", ylabel="error of the life [%]")
        left.legend()
        for name, found in lives.items():
            right.loglog(STEPS, np.array(found) / found[0], "s-", label=name)
        right.set(xlabel="largest damage increment of a block", ylabel="life / life at 0.2")
        right.legend()
        for axes in (left, right):
            axes.set_xticks(STEPS, [f"{step:g}" for step in STEPS])
            axes.xaxis.set_minor_formatter(NullFormatter())
            axes.grid(True)
