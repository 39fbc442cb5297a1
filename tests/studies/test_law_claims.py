"""The claims about laws hold for those shipped, and each one finds the fault that it is about."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pearlite_petsc.arrays import FloatArray
from pearlite_petsc.check_law import main
from pearlite_petsc.config.law_files import laws_of_file
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.fatigue.cycle_jumps.euler import Euler
from pearlite_petsc.fatigue.cycle_jumps.situation import Block, Situation
from pearlite_petsc.fatigue.damage import objective
from pearlite_petsc.laws import CycleJumpLaw, DamageLaw, SpringLaw
from pearlite_petsc.laws.law import Law
from pearlite_petsc.mechanics.springs import Stiffness
from pearlite_petsc.scene import CycleJump
from pearlite_petsc.studies.law_claims.law import law_claims
from tests.docs.test_extending import laws_of_the_page, saved
from tests.scenes import default_scene


def failed(law: Law) -> list[str]:
    scene = default_scene()
    chosen = replace(getattr(scene, law.table), **{law.key: law})
    section = law_claims(law, replace(scene, **{law.table: chosen}))
    assert section.claims
    return [claim.statement for claim in section.claims if not claim.holds]


@pytest.mark.parametrize("law", SHIPPED.laws, ids=lambda law: f"{law.table} {law.name}")
def test_every_claim_holds_for_the_laws_shipped(law: Law) -> None:
    assert failed(law) == []


@pytest.mark.parametrize("name", laws_of_the_page())
def test_every_claim_holds_for_the_laws_of_the_page(name: str, tmp_path: Path) -> None:
    assert [failed(law) for law in laws_of_file(saved(name, tmp_path))] == [[]]


def creeping(stress: FloatArray, threshold: FloatArray, factor: FloatArray) -> FloatArray:
    return factor * np.maximum(stress, 0.0) ** 3


def saturating(stress: FloatArray, threshold: FloatArray, factor: FloatArray) -> FloatArray:
    over = np.maximum(stress - threshold, 0.0)
    return factor * over**3 / (1.0 + (over / 2000.0) ** 4)


def with_rate(rate: Callable[..., FloatArray]) -> Callable[..., Any]:
    return lambda i, d: replace(objective(i, d), component_rate=rate)


FAULTS: dict[str, tuple[Callable[..., Any], str]] = {
    "shape": (lambda i, d: replace(objective(i, d), factor=np.ones(3)), "The law answers"),
    "negative": (
        lambda i, d: replace(objective(i, d), threshold=-i.length),
        "The law answers",
    ),
    "error": (lambda i, d: 1 / 0, "The law answers"),
    "no damage": (lambda i, d: replace(objective(i, d), factor=0.0 * i.length), "Some interfaces"),
    "not local": (
        lambda i, d: replace(objective(i, d), factor=d.c / (i.strength * i.length.mean())),
        "The same again",
    ),
    "undeclared distance": (
        lambda i, d: replace(objective(i, d), threshold=i.crack_distance),
        "follows_crack = False",
    ),
    "no threshold": (with_rate(creeping), "Nothing up to the threshold"),
    "not elementwise": (
        lambda i, d: replace(
            objective(i, d),
            component_rate=lambda s, t, f: f * np.maximum(s - t, 0.0) ** 3 * i.length,
        ),
        "The rate of some interfaces",
    ),
    "not monotone": (with_rate(saturating), "More stress is never less damage"),
    "square of C": (
        lambda i, d: replace(objective(i, d), factor=1e9 * d.c**2 / (i.strength * i.length)),
        "The rate is proportional to C",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_damage_law_fails_the_claim_about_its_fault(fault: str) -> None:
    function, claim = FAULTS[fault]
    wrong = failed(DamageLaw(name="own", help="for tests", function=function))
    assert any(statement.startswith(claim) for statement in wrong), wrong


def test_a_law_that_declares_to_follow_the_crack_and_does_not_fails() -> None:
    law = DamageLaw(name="own", help="for tests", function=objective, follows_crack=True)
    assert [statement.split(":")[0] for statement in failed(law)] == ["follows_crack = True"]


SPRING_FAULTS: dict[str, tuple[Callable[..., Any], str]] = {
    "no sliding": (
        lambda i, m: Stiffness(m.youngs_modulus / i.centre_distance, 0.0 * i.length),
        "The law answers",
    ),
    "not local": (
        lambda i, m: Stiffness(*2 * [m.youngs_modulus / i.centre_distance / len(i.length)]),
        "The same again",
    ),
    "root of E": (
        lambda i, m: Stiffness(*2 * [m.youngs_modulus**0.5 / i.centre_distance]),
        "Twice Young's modulus",
    ),
}


@pytest.mark.parametrize("fault", SPRING_FAULTS)
def test_a_faulty_spring_law_fails_the_claim_about_its_fault(fault: str) -> None:
    function, claim = SPRING_FAULTS[fault]
    wrong = failed(SpringLaw(name="own", help="for tests", function=function))
    assert any(statement.startswith(claim) for statement in wrong), wrong


def without_arrest(start: Situation, settings: CycleJump) -> Block | None:
    block = Euler(settings.delta_d)(start)
    return Block(1.0, np.ones(1)) if block is None else block


def too_long(start: Situation, settings: CycleJump) -> Block | None:
    block = Euler(settings.delta_d)(start)
    return None if block is None else replace(block, cycles=2.0 * block.cycles)


def almost(start: Situation, settings: CycleJump) -> Block | None:
    block = Euler(settings.delta_d)(start)
    return None if block is None else replace(block, damage=np.minimum(block.damage, 0.999))


def healing(start: Situation, settings: CycleJump) -> Block | None:
    block = Euler(settings.delta_d)(start)
    if block is None or not 0.35 < start.damage[0] < 0.45:
        return block
    return replace(block, damage=start.damage - 0.01, cycles=0.0)


JUMP_FAULTS: dict[str, tuple[Callable[..., Any], str]] = {
    "no arrest": (without_arrest, "Nothing grows at the threshold"),
    "too long": (too_long, "Cycles to failure"),
    "no end": (almost, "The last block ends exactly"),
    "healing": (healing, "Blocks take cycles"),
}


@pytest.mark.parametrize("fault", JUMP_FAULTS)
def test_a_faulty_cycle_jump_fails_the_claim_about_its_fault(
    fault: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pearlite_petsc.fatigue.lone_interface.MOST_BLOCKS", 300)
    function, claim = JUMP_FAULTS[fault]
    wrong = failed(CycleJumpLaw(name="own", help="for tests", function=function))
    assert any(statement.startswith(claim) for statement in wrong), wrong


def test_the_command_prints_a_line_a_claim_and_ends_with_1_if_one_fails(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = saved("my_law.py", tmp_path)
    assert main([str(file), "--set", "damage.film_strength=0.25"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == '[damage] law = "soft_film"'
    assert lines[-1] == f"11 claims, 0 do not hold: {file}"
    assert sum(line.startswith("  pass  ") for line in lines) == 11
    file.write_text(file.read_text().replace("return objective(", "return 0.5 and objective("))
    file.write_text(file.read_text().replace("help=", "follows_crack=True, help="))
    assert main([str(file)]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert sum(line.startswith("  FAIL  follows_crack") for line in lines) == 1


def test_the_command_refuses_what_it_cannot_use(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path / "none.py")]) == 2
    assert "none.py: cannot be read" in capsys.readouterr().err
    file = saved("my_law.py", tmp_path)
    assert main([str(file), "--set", "damage.film_strength=2"]) == 2
    assert "film_strength = 2 must be at least 0.01 and at most 1" in capsys.readouterr().err
