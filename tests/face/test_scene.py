"""Scenes from Python: the file's names and units, nothing else accepted."""

from pathlib import Path

import numpy as np
import pytest

import pearlite_petsc as pp
from tests.docs.pages import ROOT
from tests.face.scenes import TABLES, small_scene


def test_a_scene_of_nothing_is_the_quickstart() -> None:
    file = pp.load_scene(ROOT / "runs" / "quickstart.toml")
    assert pp.Scene("quickstart") == file
    assert hash(pp.Scene("quickstart")) == hash(file)
    assert pp.Scene("other") != file


def test_keywords_a_dictionary_and_a_file_give_the_same_scene(tmp_path: Path) -> None:
    scene = pp.Scene.from_dict(TABLES)
    assert pp.Scene(**TABLES) == scene
    assert pp.Scene.from_dict(scene.to_dict()) == scene
    (tmp_path / "small.toml").write_text(scene.to_toml())
    assert pp.load_scene(tmp_path / "small.toml") == scene


def test_values_are_in_the_units_of_the_file() -> None:
    scene = small_scene()
    assert scene["loading"]["delta_k_mpa_sqrt_m"] == (4.0, 18.0)
    assert scene["material"]["youngs_modulus_gpa"] == 206.0
    assert scene.states["severe_AT"]["delta_k_th_mpa_sqrt_m"] == 2.3
    assert [*scene.states] == ["undeformed", "severe_AT"]


def test_a_scene_cannot_be_changed() -> None:
    scene = small_scene()
    with pytest.raises(TypeError):
        scene["loading"]["load_ratio"] = 0.5
    with pytest.raises(TypeError):
        scene.states["new"] = {}


def test_numbers_of_numpy_are_numbers() -> None:
    levels = np.array([8.0, 12.5])
    scene = pp.Scene(
        loading={"delta_k_mpa_sqrt_m": levels, "load_ratio": np.float32(0.25)},
        ensemble={"meshes": np.int64(3)},
    )
    assert scene["loading"]["delta_k_mpa_sqrt_m"] == (8.0, 12.5)
    assert scene["loading"]["load_ratio"] == 0.25
    assert scene["ensemble"]["meshes"] == 3


def test_replace_changes_the_named_keys_and_keeps_the_others() -> None:
    scene = small_scene()
    other = scene.replace(
        name="other", loading={"load_ratio": 0.5}, states={"severe_AT": {"yield_stress_mpa": 900.0}}
    )
    assert other.name == "other"
    assert other["loading"] == {**scene["loading"], "load_ratio": 0.5}
    assert other.states["severe_AT"] == {**scene.states["severe_AT"], "yield_stress_mpa": 900.0}
    assert other.states["undeformed"] == scene.states["undeformed"]
    assert scene["loading"]["load_ratio"] == 0.1


def test_replace_keeps_the_states_of_a_list_in_its_order() -> None:
    scene = small_scene()
    assert [*scene.replace(states=["severe_AT", "undeformed"]).states] == [
        "severe_AT",
        "undeformed",
    ]
    assert [*scene.replace(states=("severe_AT",)).states] == ["severe_AT"]
    with pytest.raises(pp.PearliteError, match="state severe_TA is unknown, did you mean severe_A"):
        scene.replace(states=["severe_TA"])


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        ({"loading": {"delta_k": [18e3]}}, "delta_k is unknown, did you mean delta_k_mpa_sqrt_m?"),
        ({"loading": {"delta_k_mpa_sqrt_m": [18e3]}}, "value 1 = 18000.0 must be at least 0.001"),
        ({"loading": {"delta_k_mpa_sqrt_m": 18.0}}, "must be a list of numbers"),
        ({"loading": {"load_ratio": float("nan")}}, "load_ratio = nan is not a finite number"),
        ({"loading": {"load_ratio": True}}, "load_ratio = true is not a number"),
        ({"loding": {}}, r"\[loding\] is unknown, did you mean loading?"),
        ({"loading": 3}, r"\[loading\] = 3 must be a table"),
        ({"states": {"mine": {}}}, "shear_strain is missing"),
        ({"states": {}}, "at least one state is needed"),
        ({"name": "a/b"}, "must be letters, digits"),
        ({"window": {"notch_um": 300.0}}, "notch_um = 300 must be below width_um = 200"),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(
    tables: dict[str, object], message: str
) -> None:
    with pytest.raises(pp.PearliteError, match=message) as refused:
        pp.Scene.from_dict(tables)
    assert str(refused.value).startswith("Scene: ")
    assert "\n" not in str(refused.value)


def test_what_is_no_table_is_refused() -> None:
    with pytest.raises(pp.PearliteError, match="is not a mapping of tables"):
        pp.Scene.from_dict([("loading", {})])  # type: ignore[arg-type]
    with pytest.raises(pp.PearliteError, match="no such file, did you mean .*quickstart.toml?"):
        pp.load_scene(ROOT / "runs" / "quickstrat.toml")


def test_the_text_tells_what_there_is_to_compute() -> None:
    text = "<Scene small: 2 states x 2 meshes x 2 Delta-K = 8 cracks, window 80 x 80 um>"
    assert repr(small_scene()) == text
    one = small_scene().replace(
        states=["severe_AT"], ensemble={"meshes": 1}, loading={"delta_k_mpa_sqrt_m": [18.0]}
    )
    assert "1 state x 1 mesh x 1 Delta-K = 1 crack," in repr(one)


LAW = """
from pearlite_petsc.fatigue.damage import printed
from pearlite_petsc.laws import DamageLaw, Limits, number


def slow(interfaces, damage, *, share):
    return printed(interfaces, damage)


LAWS = [
    DamageLaw(
        name="slow",
        help="for tests",
        function=slow,
        parameters=(number("share", 0.5, "for tests", Limits(0.0, 1.0)),),
    )
]
"""


def test_a_law_of_a_file_is_loaded_by_name_and_stays_with_the_scene(tmp_path: Path) -> None:
    file = tmp_path / "slow.py"
    file.write_text(LAW)
    scene = pp.Scene(load=file, damage={"law": "slow", "share": 0.25})
    assert scene["damage"]["share"] == 0.25 and len(scene["damage"]["law_sha256"]) == 64
    assert scene.replace(microstructure={"seed": 7})["damage"] == scene["damage"]
    assert pp.Scene.from_dict(scene.to_dict(), load=[file]) == scene
    (tmp_path / "scene.toml").write_text(scene.to_toml())
    assert pp.load_scene(tmp_path / "scene.toml", load=file) == scene
    with pytest.raises(pp.PearliteError, match=r'"slow" must be one of .*--load FILE\.py'):
        pp.load_scene(tmp_path / "scene.toml")
    file.write_text(LAW.replace("printed(interfaces", "0 * printed(interfaces"))
    with pytest.raises(pp.PearliteError, match=r"of .*slow\.py fails: TypeError"):
        pp.Scene(load=file, damage={"law": "slow"})


def test_results_of_a_law_of_a_file_are_read_without_it(tmp_path: Path) -> None:
    file = tmp_path / "slow.py"
    file.write_text(LAW)
    chosen = {"damage": {"law": "slow", "share": 0.25}, "ensemble": {"meshes": 1}}
    few = {
        "states": {"severe_AT": {}},
        "loading": {"delta_k_mpa_sqrt_m": [18.0], "extension_um": 5},
    }
    scene = pp.Scene.from_dict({**TABLES, **chosen, **few}, load=file)
    found = pp.run(scene, tmp_path / "out")
    again = pp.read_results(tmp_path / "out")
    assert list(again.cracks()["cycles"]) == list(found.cracks()["cycles"])
    assert again.scene["damage"] == scene["damage"]
    assert again.provenance["laws"][0]["parameters"] == {"share": 0.25}
