"""Whatever a scene file holds: a scene, or one line that says why not."""

import tomllib
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pearlite_petsc.config import load_scene, load_scene_text, scene_to_toml
from pearlite_petsc.config.checks import MOST_ELEMENTS, estimated_elements
from pearlite_petsc.config.keys import TABLES
from pearlite_petsc.errors import SceneError

PRESET = Path(__file__).parents[2] / "runs" / "quickstart.toml"
LINES = PRESET.read_text().splitlines()
KEYS = [(table, key) for table, keys in tomllib.loads("\n".join(LINES)).items() for key in keys]
VALUES = st.one_of(
    st.floats().map(lambda x: repr(x).replace("inf", "inf")),
    st.integers(-(10**40), 10**40).map(str),
    st.sampled_from(
        [
            "true",
            "''",
            '"two"',
            "[]",
            "[[]]",
            "{}",
            "{a = 1}",
            "nan",
            "-inf",
            "1e-400",
            "1e400",
            "2020-01-01",
            "07:00:00",
            "0x10",
            "1_000",
            "-0.0",
            "[1, 'a']",
            "[nan]",
            "",
            "= 3",
            "\x00",
        ]
    ),
    st.lists(st.floats(0.1, 100.0), max_size=4).map(str),
    st.floats(0.01, 300.0).map(repr),
    st.text(max_size=12),
)
MANY = settings(max_examples=250, suppress_health_check=[HealthCheck.function_scoped_fixture])


def scene_or_one_line(load: Any, *arguments: Any) -> None:
    try:
        scene = load(*arguments)
    except SceneError as error:
        line = str(error)
        assert line.isprintable()
        assert ": " in line
        assert len(line) < 1000
        return
    assert scene.states
    assert scene.loading.delta_k
    assert 0 < estimated_elements(scene) <= MOST_ELEMENTS
    assert load_scene_text(scene_to_toml(scene), "a.toml") == scene


@MANY
@given(st.lists(st.tuples(st.sampled_from(range(len(LINES))), VALUES), min_size=1, max_size=3))
def test_a_file_with_changed_values_is_a_scene_or_one_line(changes: list[tuple[int, str]]) -> None:
    lines = list(LINES)
    for number, value in changes:
        name, equals, _ = lines[number].partition("=")
        lines[number] = f"{name}= {value}" if equals else value
    scene_or_one_line(load_scene_text, "\n".join(lines), "a.toml")


@MANY
@given(st.data())
def test_a_file_with_lines_lost_doubled_or_swapped_is_a_scene_or_one_line(data: Any) -> None:
    lines = list(LINES)
    for _ in range(data.draw(st.integers(1, 4))):
        number = data.draw(st.integers(0, len(lines) - 1))
        match data.draw(st.sampled_from(["lose", "double", "swap", "cut", "rename"])):
            case "lose":
                del lines[number]
            case "double":
                lines.insert(number, lines[number])
            case "swap":
                lines[number], lines[0] = lines[0], lines[number]
            case "cut":
                lines[number] = lines[number][: len(lines[number]) // 3]
            case "rename":
                lines[number] = lines[number].replace("_um", data.draw(st.text(max_size=3)))
    scene_or_one_line(load_scene_text, "\n".join(lines), "a.toml")


@MANY
@given(st.one_of(st.binary(max_size=300), st.text(max_size=300).map(lambda text: text.encode())))
def test_a_file_of_junk_is_a_scene_or_one_line(tmp_path: Path, junk: bytes) -> None:
    file = tmp_path / "junk.toml"
    file.write_bytes(junk)
    scene_or_one_line(load_scene, file)


@MANY
@given(
    st.sampled_from(KEYS),
    st.one_of(VALUES, st.text(max_size=20)),
    st.sampled_from([".", "..", ".x.", ""]),
)
def test_any_override_is_a_scene_or_one_line(
    path: tuple[str, str], value: str, separator: str
) -> None:
    scene_or_one_line(load_scene, PRESET, [f"{path[0]}{separator}{path[1]}={value}"])


def test_every_number_at_its_limits_is_a_scene_or_one_line() -> None:
    for table in TABLES:
        for key in table.keys:
            if key.limits is not None:
                for number in (key.limits.low, key.limits.high):
                    value = f"[{number!r}]" if key.type == "numbers" else repr(number)
                    scene_or_one_line(load_scene, PRESET, [f"{table.name}.{key.name}={value}"])
