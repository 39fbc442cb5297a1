"""Every class of bad input ends in one line with file, key, value and limit."""

from pathlib import Path

import pytest

from pearlite_petsc.config import load_scene, load_scene_text
from pearlite_petsc.errors import SceneError


def message(text: str, *overrides: str) -> str:
    with pytest.raises(SceneError) as caught:
        load_scene_text(text, "runs/a.toml", overrides)
    line = str(caught.value)
    assert "\n" not in line
    return line


WHOLE_STATE = """
shear_strain = 1.0
orientation = "AT"
yield_stress_mpa = 700.0
delta_k_th_mpa_sqrt_m = 4.0
"""


OTHER_VALUES = "NA nan null None TRUE F 007 1e5 12 0x1F 1_000 inf 2026-11-27 1-2 MAR1 2-mar sept2"


@pytest.mark.parametrize("name", OTHER_VALUES.split())
def test_a_name_that_table_readers_take_for_something_else_is_refused(name: str) -> None:
    said = message(f"[states.{name}]\n{WHOLE_STATE}")
    assert f"[states] {name} is no name for a state: table readers" in said


@pytest.mark.parametrize("name", ["R260", "1st", "7a", "nano", "nullified", "350-HT", "march_rail"])
def test_a_name_that_looks_a_little_like_it_is_taken(name: str) -> None:
    scene = load_scene_text(f"[states.{name}]\n{WHOLE_STATE}", "a.toml")
    assert scene.states[0].name == name


def message_of_file(path: Path | str) -> str:
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("[elements]\nwidht_um = 2", "[elements] widht_um is unknown, did you mean width_um?"),
        ("[damage]\ndelta_d = 2", "[damage] delta_d is unknown, it belongs to [cycle_jump]"),
        ("[output]\nx = 2", "known are fields, field_steps, figures, experiment"),
        ("[elemnts]", "[elemnts] is unknown, did you mean elements?"),
        ("width_um = 2", "[width_um] is unknown, it belongs to [elements]"),
        ("[states.a.b]", "[states.a] b is unknown, known are shear_strain"),
        ("[states.mine]\nshear_strain = 1", "[states.mine] orientation is missing"),
        ("[elements]\nwidth_um = true", "[elements] width_um = true is not a number"),
        ('[elements]\nwidth_um = "2"', '[elements] width_um = "2" is not a number'),
        ("[elements]\nwidth_um = 2020-01-01", "width_um = 2020-01-01 is not a number"),
        ("[elements]\nwidth_um = {}", "[elements] width_um = a table is not a number"),
        ("[elements]\nwidth_um = nan", "[elements] width_um = NaN is not a finite number"),
        ("[elements]\nwidth_um = -inf", "width_um = -Infinity is not a finite number"),
        ("[elements]\nwidth_um = 1e999", "width_um = Infinity is not a finite number"),
        ("[elements]\nwidth_um = -2.5", "width_um = -2.5 must be at least 0.01 and at most 100000"),
        ("[elements]\nwidth_um = 0", "width_um = 0 must be at least 0.01"),
        ("[elements]\nwidth_um = 1e-30", "width_um = 1E-30 must be at least 0.01"),
        ("[elements]\nwidth_um = 1e30", "width_um = 1E+30 must be at least 0.01 and at most"),
        ("[elements]\nwidth_um = 0e99999999999999999999", "width_um = 0 must be at least 0.01"),
        ("[elements]\ncoarsest = 0.5", "[elements] coarsest = 0.5 must be at least 1"),
        ("[material]\npoisson_ratio = 0.5", "poisson_ratio = 0.5 must be above -1 and below 0.5"),
        ("[material]\npoisson_ratio = -1", "poisson_ratio = -1 must be above -1 and below 0.5"),
        (
            '[material]\nsprings = "Raje"',
            '= "Raje" must be one of "homogeneous", "matched", "raje"',
        ),
        ("[material]\nsprings = 1", "[material] springs = 1 is not a text"),
        ("[output]\nfigures = 1", "[output] figures = 1 must be true or false"),
        ('[output]\nexperiment = "\\u0000"', 'experiment = "\\x00" must be printable'),
        ("[ensemble]\nmeshes = 0", "[ensemble] meshes = 0 must be at least 1"),
        ("[ensemble]\nmeshes = 2.0", "[ensemble] meshes = 2.0 is not a whole number"),
        ("[ensemble]\nmeshes = true", "[ensemble] meshes = true is not a whole number"),
        ("[microstructure]\nseed = -1", "[microstructure] seed = -1 must be at least 0"),
        ("[loading]\nload_ratio = 1", "load_ratio = 1 must be at least 0 and at most 0.95"),
        (
            "[loading]\nload_ratio = 0.9999999999999999",
            "load_ratio = 0.9999999999999999 must be at least 0 and at most 0.95",
        ),
        ("[loading]\ndelta_k_mpa_sqrt_m = 8", "delta_k_mpa_sqrt_m = 8 must be a list of numbers"),
        ("[loading]\ndelta_k_mpa_sqrt_m = []", "delta_k_mpa_sqrt_m = [] is empty"),
        ("[loading]\ndelta_k_mpa_sqrt_m = [8, -1]", "value 2 = -1 must be at least 0.001"),
        ("[loading]\ndelta_k_mpa_sqrt_m = [8, nan]", "value 2 = NaN is not a finite number"),
        ("[loading]\ndelta_k_mpa_sqrt_m = [8, 9, 8.0]", "value 3 = 8.0 is there twice"),
        ("[loading]\ndelta_k_mpa_sqrt_m = [8, '9']", 'value 2 = "9" is not a number'),
        ("states = 3", "[states] = 3 must be a table of states"),
        ("[states]", "[states] is empty, at least one state is needed"),
        ("[states]\nsevere_AT = 3", "[states] severe_AT = 3 must be a table"),
        ("[states.'../x']", "[states] ../x is no name for a state"),
        ("[states.'']", "is no name for a state"),
        ("[states.severe_AT]\n[states.Severe_at]", "differs from another state by upper and lower"),
        ("window = 3", "[window] = 3 must be a table"),
        ("[[window]]", "[window] = [a table] must be a table"),
        ('name = "a/b"', 'name = "a/b" must be letters, digits'),
        ("name = 3", "name = 3 must be letters, digits"),
    ],
)
def test_a_bad_key_or_value_is_named(text: str, expected: str) -> None:
    line = message(text)
    assert line.startswith("runs/a.toml: ")
    assert expected in line


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        (["microstructure.block_um=70"], "block_um = 70 must be at most prior_austenite_grain_um"),
        (["microstructure.colony_um=31"], "colony_um = 31 must be at most block_um = 30"),
        (["window.notch_um=200"], "[window] notch_um = 200 must be below width_um = 200"),
        (["loading.extension_um=120"], "notch_um + extension_um = 200, [window] width_um = 200"),
        (["elements.length_um=101"], "differ by more than a factor of 50"),
        (["elements.width_um=16"], "width_um = 16 must be at most [microstructure] colony_um = 15"),
        (["window.height_um=10"], "height_um = 10 must be at least four elements = 16"),
        (["elements.radius_um=7.9"], "radius_um = 7.9 must be at least two elements = 8"),
        (
            ["elements.refinement=corridor", "elements.corridor_um=7"],
            "corridor_um = 7 must be at least two elements = 8",
        ),
        (
            ["damage.stress=nominal", "damage.failure_damage=1"],
            'failure_damage = 1 must be below 1 with stress = "nominal"',
        ),
        (["loading.control=stress"], '[loading] control = "stress" needs kind = "edge_crack"'),
        (
            ["elements.refinement=uniform", "elements.width_um=0.01", "elements.length_um=0.1"],
            "asks for about 4e+07 elements per mesh, at most 5e+06",
        ),
        (
            ["microstructure.colony_um=2.5", "states.severe_AT.shear_strain=1000"],
            "[states.severe_AT] shear_strain = 1000 in a window of 200 x 200 um asks for about "
            "8.2e+06 colonies before shear, at most 5e+06",
        ),
        (
            ["microstructure.colony_um=2", "window.width_um=5000", "window.height_um=5000"],
            "[microstructure] colony_um = 2 asks for about",
        ),
        (
            ["window.notch_um=187.9", "loading.extension_um=12"],
            "[loading] extension_um = 12 does not fit: notch_um + extension_um = 199.9, [window] "
            "width_um = 200 less one element = 196",
        ),
        (["window.notch_um=199", "loading.extension_um=0.5"], "less one element = 196"),
        (["ensemble.meshes=100000"], "meshes = 100000 asks for 2000000 tasks, at most 1e+06"),
    ],
)
def test_keys_that_do_not_fit_together_are_named(overrides: list[str], expected: str) -> None:
    assert expected in message("", *overrides)


@pytest.mark.parametrize("nu", ["0.3333333333333334", "0.4"])
def test_springs_of_the_source_are_refused_where_the_shear_stiffness_is_not_positive(
    nu: str,
) -> None:
    line = message("", "material.springs=raje", f"material.poisson_ratio={nu}")
    assert "poisson_ratio" in line
    assert "k_t = E (1 - 3 nu) t/((1 - nu^2) L_eq), Eq. (25), is not positive" in line
    load_scene_text("", "a.toml", ["material.springs=raje", "material.poisson_ratio=0.333"])
    load_scene_text("", "a.toml", ["material.springs=matched", f"material.poisson_ratio={nu}"])


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("elements", "must have the form table.key=value"),
        ("elements=3", "must have the form table.key=value"),
        ("a.b.c.d=3", "must have the form table.key=value"),
        ("elements..width_um=3", "must have the form table.key=value"),
        ("elements.width_um.x=3", "must have the form table.key=value"),
        ("elements.width_um=", '"" is not a value'),
        ("elements.width_um=[3", '"[3" is not a value'),
        ("elements.width_um=3\nlength_um=1", "is not one value"),
        ("elements.width_um=wide", '[elements] width_um = "wide" is not a number'),
        ("elements.widht_um=3", "[elements] widht_um is unknown, did you mean width_um?"),
        ("elemnts.width_um=3", "[elemnts] is unknown, did you mean elements?"),
    ],
)
def test_a_bad_override_is_named_instead_of_the_file(override: str, expected: str) -> None:
    line = message("[window]\nnotch_um = 80", override)
    assert line.startswith(("--set ele", "--set a.b"))
    assert expected in line


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("[elements]\nwidth_um 2", "line 2"),
        ("[elements]\nwidth_um = 2\nwidth_um = 3", "line 3"),
        ("[elements\n", "line 1"),
        ("a = [1,\n2,\n", "line 3"),
        ("a = " + "[" * 5000, "nested too deeply"),
        ("a = 1" + "0" * 5000, "is not valid TOML"),
        ("[elements]\nwidth_um = 1979-99-99", "is not valid TOML"),
    ],
)
def test_broken_toml_is_named_with_its_line(text: str, expected: str) -> None:
    line = message(text)
    assert line.startswith("runs/a.toml: is not valid TOML: ")
    assert expected in line


def test_a_missing_file_is_named_with_the_nearest_scene(tmp_path: Path) -> None:
    (tmp_path / "severe.toml").write_text("")
    line = message_of_file(tmp_path / "sevre.toml")
    assert line.endswith(f"sevre.toml: no such file, did you mean {tmp_path / 'severe.toml'}?")
    assert message_of_file(tmp_path / "qqq.toml").endswith("qqq.toml: no such file")
    assert message_of_file(tmp_path / "nowhere" / "a.toml").endswith("a.toml: no such file")


def test_a_folder_binary_junk_and_a_huge_file_are_refused(tmp_path: Path) -> None:
    assert "is a folder" in message_of_file(tmp_path)
    junk = tmp_path / "junk.toml"
    junk.write_bytes(bytes(range(256)))
    assert "is not a text file (UTF-8)" in message_of_file(junk)
    junk.write_bytes(b"#" * 1_000_001)
    assert "1000001 bytes, more than 1000000" in message_of_file(junk)
    assert "is not a regular file" in message_of_file("/dev/null")
    assert "cannot be read" in message_of_file("a" * 5000)
    message_of_file("a\0b")


def test_line_breaks_in_keys_values_and_names_stay_in_one_line(tmp_path: Path) -> None:
    assert "wi\\ndth" in message('[elements]\n"wi\\ndth" = 2')
    assert "ra\\nje" in message('[material]\nsprings = "ra\\nje"')
    assert "a\\nb.toml" in message_of_file(tmp_path / "a\nb.toml")
