"""Scene files that are right: presets, defaults, overrides, units, round trip, hash, schema."""

import json
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pearlite_petsc.config import (
    estimated_elements,
    load_scene,
    load_scene_text,
    scene_difference,
    scene_hash,
    scene_schema,
    scene_to_toml,
)
from pearlite_petsc.config.keys import TABLES
from pearlite_petsc.config.states import STATE_KEYS

RUNS = Path(__file__).parents[2] / "runs"
PRESETS = ("quickstart", "paper", "source")
SCHEMA = jsonschema.Draft202012Validator(scene_schema())


def preset(name: str) -> dict[str, Any]:
    return tomllib.loads((RUNS / f"{name}.toml").read_text())


def test_an_empty_scene_is_the_quickstart() -> None:
    assert load_scene_text("", "quickstart.toml") == load_scene(RUNS / "quickstart.toml")


def test_units_are_converted_to_micrometres_and_megapascals() -> None:
    scene = load_scene(RUNS / "quickstart.toml")
    assert scene.material.youngs_modulus == 206_000.0
    assert scene.damage.cementite_strength == 20_000.0
    assert scene.damage.c == 4.41e-9
    assert scene.loading.delta_k == (8000.0, 12000.0, 18000.0, 25000.0)
    assert [state.delta_k_th for state in scene.states] == [5000.0, 4000.0, 2300.0, 4000.0, 2300.0]
    assert [state.yield_stress for state in scene.states] == [470.0, 616.0, 1024.0, 616.0, 1024.0]
    assert [state.shear_strain for state in scene.states] == [0.0, 2.0, 30.0, 2.0, 30.0]
    assert [state.orientation for state in scene.states] == ["AT", "AT", "AT", "TA", "TA"]


def test_the_paper_preset_has_160_tasks_of_the_quickstart() -> None:
    quickstart, paper = load_scene(RUNS / "quickstart.toml"), load_scene(RUNS / "paper.toml")
    assert len(paper.states) * paper.ensemble.meshes * len(paper.loading.delta_k) == 160
    assert [
        line.split(":")[0] for line in scene_difference(*map(scene_to_toml, (quickstart, paper)))
    ] == ["[loading] delta_k_mpa_sqrt_m"]


def test_the_source_preset_makes_the_choices_of_the_source() -> None:
    scene = load_scene(RUNS / "source.toml")
    assert scene.material.springs.name == "raje"
    assert (scene.damage.law.name, scene.damage.stress) == ("printed", "nominal")
    assert scene.damage.threshold == "remote"
    assert (scene.loading.kind, scene.loading.control) == ("edge_crack", "stress")
    assert (scene.cycle_jump.method.name, scene.cycle_jump.delta_d) == ("euler", 0.1)


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_lists_every_key_with_a_comment(name: str) -> None:
    tables = preset(name)
    for table in TABLES:
        assert set(tables[table.name]) == {key.name for key in table.keys}
    for state in tables["states"].values():
        assert set(state) == {key.name for key in STATE_KEYS}
    for line in (RUNS / f"{name}.toml").read_text().splitlines():
        assert "=" not in line.split("#")[0] or "  # " in line, line


@pytest.mark.parametrize("name", PRESETS)
def test_a_written_scene_reads_as_an_equal_scene(name: str) -> None:
    scene = load_scene(RUNS / f"{name}.toml")
    assert load_scene_text(scene_to_toml(scene), "scene.resolved.toml") == scene


@given(
    c=st.floats(1e-12, 1e24),
    modulus=st.floats(1e-3, 1e5),
    threshold=st.floats(0.0, 1e3),
    delta_k=st.lists(st.floats(1e-3, 1e4), min_size=1, max_size=5, unique_by=lambda k: f"{k:.4g}"),
)
def test_any_number_survives_writing_bit_for_bit(
    c: float, modulus: float, threshold: float, delta_k: list[float]
) -> None:
    overrides = (
        f"damage.c_um5_per_n2={c!r}",
        f"material.youngs_modulus_gpa={modulus!r}",
        f"states.severe_AT.delta_k_th_mpa_sqrt_m={threshold!r}",
        f"loading.delta_k_mpa_sqrt_m={delta_k!r}",
    )
    scene = load_scene_text("", "a.toml", overrides)
    again = load_scene_text(scene_to_toml(scene), "a.toml")
    assert again == scene
    assert scene_hash(again) == scene_hash(scene)
    assert scene.damage.c == pytest.approx(c * 1e-12, rel=1e-15)
    assert scene.loading.delta_k == pytest.approx([k * 1000 for k in delta_k], rel=1e-15)


def test_text_with_quotes_and_backslashes_survives_writing() -> None:
    scene = load_scene_text("", "a.toml", [r"""output.experiment='C:\my "points".csv'"""])
    assert scene.output.experiment == r'C:\my "points".csv'
    assert load_scene_text(scene_to_toml(scene), "a.toml") == scene


def test_overrides_take_toml_values_and_bare_words() -> None:
    scene = load_scene_text(
        "",
        "a.toml",
        [
            "loading.delta_k_mpa_sqrt_m=[8,12]",
            "elements.width_um = 3",
            "states.severe_AT.shear_strain=10",
            "material.springs=matched",
            "output.figures=false",
            "output.experiment=my points.csv",
        ],
    )
    assert scene.loading.delta_k == (8000.0, 12000.0)
    assert scene.elements.width == 3.0
    assert [state.shear_strain for state in scene.states] == [0.0, 2.0, 10.0, 2.0, 30.0]
    assert scene.material.springs.name == "matched"
    assert scene.output.figures is False
    assert scene.output.experiment == "my points.csv"


def test_the_last_of_two_overrides_of_one_key_counts() -> None:
    scene = load_scene_text("", "a.toml", ["ensemble.meshes=2", "ensemble.meshes=3"])
    assert scene.ensemble.meshes == 3


def test_only_the_listed_states_are_computed_and_known_ones_need_no_data() -> None:
    text = """[states.severe_TA]
    [states.mine]
    shear_strain = 5
    orientation = "TA"
    yield_stress_mpa = 700
    delta_k_th_mpa_sqrt_m = 0
    """
    severe, mine = load_scene_text(text, "a.toml").states
    assert (severe.name, severe.shear_strain, severe.yield_stress) == ("severe_TA", 30.0, 1024.0)
    assert (mine.name, mine.shear_strain, mine.delta_k_th) == ("mine", 5.0, 0.0)


@pytest.mark.parametrize(
    ("file", "name"),
    [("runs/a.toml", "a"), ("my scene.v2.toml", "my_scene_v2"), ("....toml", "scene")],
)
def test_the_name_of_a_scene_is_the_stem_made_fit_for_a_folder(file: str, name: str) -> None:
    assert load_scene_text("", file).name == name


def test_the_hash_changes_with_physics_only() -> None:
    scene = load_scene_text("", "a.toml")
    for same in ("output.fields=all", "ensemble.ranks_per_task=2"):
        assert scene_hash(load_scene_text("", "b.toml", [same])) == scene_hash(scene)
    for other in ("microstructure.seed=2", "states.severe_AT.shear_strain=29", "damage.beta=0.31"):
        assert scene_hash(load_scene_text("", "a.toml", [other])) != scene_hash(scene)


def test_the_difference_of_two_scenes_names_the_keys_and_both_values() -> None:
    old = load_scene_text("[states.severe_AT]", "a.toml")
    new = load_scene_text("[states.severe_AT]\nshear_strain = 29\n", "a.toml", ["damage.beta=0.5"])
    assert scene_difference(*map(scene_to_toml, (old, new))) == (
        "[states.severe_AT] shear_strain: 30.0, now 29.0",
        "[damage] beta: 0.3, now 0.5",
    )


def test_the_number_of_elements_of_a_uniform_mesh_is_the_area_over_the_element() -> None:
    scene = load_scene_text("", "a.toml", ["elements.refinement=uniform"])
    assert estimated_elements(scene) == 200 * 200 / (2 * 4)


def test_the_number_of_elements_of_a_graded_mesh_is_the_integral_of_its_density() -> None:
    scene = load_scene_text("", "a.toml", ["elements.refinement=corridor"])
    points = [(index + 0.5) / 100 for index in range(20_000)]
    spacing = [min(8.0, 1 + 0.08 * max(0.0, abs(y - 100) - 30)) for y in points]
    expected = sum(200 * 0.01 / (8 * s**2) for s in spacing)
    assert estimated_elements(scene) == pytest.approx(expected, rel=2e-3)


def test_the_schema_is_valid_and_can_be_written_as_json() -> None:
    jsonschema.Draft202012Validator.check_schema(scene_schema())
    assert json.loads(json.dumps(scene_schema())) == scene_schema()


@pytest.mark.parametrize("name", PRESETS)
def test_the_schema_accepts_the_presets(name: str) -> None:
    SCHEMA.validate(preset(name))


@pytest.mark.parametrize(
    ("table", "key", "value"),
    [
        ("damage", "yeild_mpa", 1.0),
        ("elements", "width_um", -2.0),
        ("elements", "width_um", "two"),
        ("elements", "width_um", True),
        ("material", "springs", "rubber"),
        ("material", "poisson_ratio", 0.5),
        ("loading", "delta_k_mpa_sqrt_m", []),
        ("loading", "load_ratio", 1.0),
        ("ensemble", "meshes", 2.5),
        ("states", "no/name", {}),
        ("states", "mine", {"shear_strain": 2.0}),
    ],
)
def test_the_schema_refuses_what_the_reader_refuses(table: str, key: str, value: Any) -> None:
    scene = preset("quickstart")
    scene[table][key] = value
    assert not SCHEMA.is_valid(scene)
