"""Scenes that choose a law of one's own: keys, limits, schema, round trip, hash."""

from dataclasses import replace

import jsonschema
import pytest

from pearlite_petsc.config import (
    load_scene_text,
    scene_difference,
    scene_hash,
    scene_schema,
    scene_to_toml,
)
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.errors import SceneError
from pearlite_petsc.fatigue.damage import objective
from pearlite_petsc.laws import DamageInterfaces, DamageLaw, Limits, RateConstants, Source, number
from pearlite_petsc.scene import Damage, Scene


def thick(interfaces: DamageInterfaces, damage: Damage, *, film_thickness: float) -> RateConstants:
    return objective(replace(interfaces, length=interfaces.length + film_thickness), damage)


LAW = DamageLaw(
    name="thick",
    help="for tests",
    function=thick,
    parameters=(number("film_thickness", 20.0, "of a film, nm", Limits(1.0, 500.0), "nm"),),
    source=Source("thick.py", "ab" * 32),
)
LAWS = SHIPPED.joined([LAW])


def scene(*overrides: str, text: str = "") -> Scene:
    return load_scene_text(text, "a.toml", overrides, LAWS)


def message(*overrides: str, text: str = "") -> str:
    with pytest.raises(SceneError) as raised:
        scene(*overrides, text=text)
    assert "\n" not in str(raised.value)
    return str(raised.value)


def test_the_scene_holds_the_law_with_the_values_of_its_parameters() -> None:
    assert scene("damage.law=thick").damage.law.keywords() == {"film_thickness": 0.02}
    chosen = scene("damage.law=thick", "damage.film_thickness_nm=50").damage.law
    assert chosen.name == "thick" and chosen.keywords() == {"film_thickness": 0.05}
    # The catalogue still has the law as it was declared.
    assert LAWS.of(DamageLaw)[-1].values == ()


def test_a_parameter_is_checked_like_every_key() -> None:
    line = message("damage.law=thick", "damage.film_thickness_nm=501")
    assert "[damage] film_thickness_nm = 501 must be at least 1 and at most 500" in line
    line = message("damage.law=thick", "damage.film_thicknes_nm=50")
    assert "is unknown, did you mean film_thickness_nm?" in line
    line = message("damage.film_thickness_nm=50")
    assert 'is a parameter of law = "thick", not of "objective"' in line


def test_an_unknown_law_is_refused_with_those_known_and_the_way_to_add_one() -> None:
    with pytest.raises(SceneError, match=r'must be one of "objective", "printed".*--load FILE\.py'):
        load_scene_text("", "a.toml", ["damage.law=thick"])


def test_a_written_scene_needs_the_same_text_of_the_law() -> None:
    written = scene_to_toml(scene("damage.law=thick", "damage.film_thickness_nm=50"))
    assert 'law_sha256 = "abab' in written and "film_thickness_nm = 50.0" in written
    assert scene(text=written) == scene(
        "damage.law=thick", "damage.film_thickness_nm=50", text='name = "a"'
    )
    other = SHIPPED.joined([replace(LAW, source=Source("thick.py", "cd" * 32))])
    with pytest.raises(SceneError, match=r"law_sha256 .* is not the text of .*thick\.py is cdcd"):
        load_scene_text(written, "a.toml", (), other)
    shipped = message('damage.law_sha256="00"')
    assert "it comes with the program" in shipped


def test_the_hash_of_a_scene_knows_the_text_of_the_law_and_its_parameters() -> None:
    base = scene("damage.law=thick")
    other = replace(base.damage.law, source=Source("thick.py", "cd" * 32))
    changed = replace(base, damage=replace(base.damage, law=other))
    moved = replace(base.damage.law, source=Source("elsewhere/thick.py", "ab" * 32))
    assert scene_hash(changed) != scene_hash(base)
    assert scene_hash(replace(base, damage=replace(base.damage, law=moved))) == scene_hash(base)
    assert scene_hash(scene("damage.law=thick", "damage.film_thickness_nm=21")) != scene_hash(base)
    lines = scene_difference(scene_to_toml(base), scene_to_toml(changed))
    assert lines == (f"[damage] law_sha256: {'ab' * 32}, now {'cd' * 32}",)


def test_the_schema_allows_a_parameter_with_its_law_only() -> None:
    schema = jsonschema.Draft202012Validator(scene_schema(LAWS))
    jsonschema.Draft202012Validator.check_schema(scene_schema(LAWS))
    assert schema.is_valid({"damage": {"law": "thick", "film_thickness_nm": 50}})
    assert schema.is_valid({"damage": {"law": "thick"}})
    assert schema.is_valid({"damage": {"law": "printed"}})
    assert schema.is_valid({"damage": {}})
    for wrong in (
        {"law": "thick", "film_thickness_nm": 501},
        {"law": "thick", "film_thickness_nm": "50"},
        {"law": "printed", "film_thickness_nm": 50},
        {"film_thickness_nm": 50},
        {"law": "thin"},
    ):
        assert not schema.is_valid({"damage": wrong}), wrong
    plain = jsonschema.Draft202012Validator(scene_schema())
    assert not plain.is_valid({"damage": {"law": "thick"}})


def test_a_law_that_is_first_is_the_default_and_its_parameters_need_no_choice() -> None:
    laws = replace(LAWS, laws=LAWS.laws[::-1])
    found = load_scene_text("", "a.toml", ["damage.film_thickness_nm=50"], laws)
    assert found.damage.law.name == "thick"
    assert jsonschema.Draft202012Validator(scene_schema(laws)).is_valid(
        {"damage": {"film_thickness_nm": 50}}
    )


def test_a_law_may_refuse_other_values_of_its_table() -> None:
    law = replace(
        LAW, check=lambda damage: ("beta", "= 2 is too much") if damage.beta == 2.0 else None
    )
    laws = SHIPPED.joined([law])
    load_scene_text("", "a.toml", ["damage.law=thick", "damage.beta=1"], laws)
    with pytest.raises(SceneError, match=r"\[damage\] beta = 2 is too much"):
        load_scene_text("", "a.toml", ["damage.law=thick", "damage.beta=2"], laws)
