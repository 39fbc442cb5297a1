"""Laws from outside the program: files, entry points, and results whose laws are not at hand."""

import hashlib
import pickle
import sys
from pathlib import Path

import pytest

from pearlite_petsc.config import (
    find_laws,
    laws_of_results,
    laws_of_scene,
    load_scene_text,
    refuse_faulty_laws,
    scene_hash,
    scene_to_toml,
)
from pearlite_petsc.config.shipped import SHIPPED
from pearlite_petsc.errors import PearliteError, SceneError
from pearlite_petsc.laws import CycleJumpLaw, DamageLaw, SpringLaw

TEXT = """
from pearlite_petsc.fatigue.cycle_jumps.euler import Euler
from pearlite_petsc.fatigue.damage import printed
from pearlite_petsc.laws import CycleJumpLaw, DamageLaw, Limits, SpringLaw, number, switch
from pearlite_petsc.mechanics.springs import homogeneous


def film(interfaces, damage, *, thickness, wet):
    return printed(interfaces, damage)


def euler_again(start, settings):
    return Euler(settings.delta_d)(start)


LAWS = [
    DamageLaw(
        name="film",
        help="for tests",
        function=film,
        parameters=(
            number("thickness", 20.0, "of a film, nm", Limits(1.0, 500.0), "nm"),
            switch("wet", False, "whether it is wet"),
        ),
    ),
    SpringLaw(name="own_springs", help="for tests", function=homogeneous),
    CycleJumpLaw(name="own_jump", help="for tests", function=euler_again),
]
"""
CHOSEN = (
    "damage.law=film",
    "damage.thickness_nm=50",
    "damage.wet=true",
    "material.springs=own_springs",
    "cycle_jump.method=own_jump",
)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "my_law.py"
    path.write_text(TEXT)
    return path


def test_a_file_adds_its_laws_to_those_shipped_and_to_no_other_catalogue(file: Path) -> None:
    laws = find_laws([file])
    assert set(laws.laws) - set(SHIPPED.laws) == {
        laws.named(DamageLaw, "film"),
        laws.named(SpringLaw, "own_springs"),
        laws.named(CycleJumpLaw, "own_jump"),
    }
    assert not set(find_laws().laws) - set(SHIPPED.laws)
    sha256 = hashlib.sha256(file.read_bytes()).hexdigest()
    for law in set(laws.laws) - set(SHIPPED.laws):
        assert law.source is not None
        assert (law.source.file, law.source.sha256) == (str(file), sha256)


def test_the_scene_says_which_laws_it_has_from_where(file: Path) -> None:
    scene = load_scene_text("", "a.toml", CHOSEN, find_laws([file]))
    refuse_faulty_laws(scene)
    damage, springs, jump = laws_of_scene(scene)
    sha256 = hashlib.sha256(file.read_bytes()).hexdigest()
    assert damage == {
        "table": "damage",
        "key": "law",
        "name": "film",
        "parameters": {"thickness_nm": 50.0, "wet": True},
        "file": str(file),
        "sha256": sha256,
    }
    assert (springs["name"], jump["name"]) == ("own_springs", "own_jump")
    shipped = laws_of_scene(load_scene_text("", "a.toml"))
    assert [law["name"] for law in shipped][1:] == ["homogeneous", "compliance"]
    assert not any("sha256" in law for law in shipped)


def test_any_other_text_is_another_scene(file: Path) -> None:
    scene = load_scene_text("", "a.toml", CHOSEN, find_laws([file]))
    written = scene_to_toml(scene)
    file.write_text(TEXT + "# the same but for this line\n")
    other = load_scene_text("", "a.toml", CHOSEN, find_laws([file]))
    assert scene_hash(other) != scene_hash(scene)
    with pytest.raises(SceneError, match=r"springs_sha256 = .* is not the text of"):
        load_scene_text(written, "a.toml", (), find_laws([file]))


def test_a_scene_with_laws_of_a_file_can_be_pickled(file: Path) -> None:
    scene = load_scene_text("", "a.toml", CHOSEN, find_laws([file]))
    assert pickle.loads(pickle.dumps(scene)) == scene


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has no laws: LAWS must be a list of DamageLaw, SpringLaw or CycleJumpLaw"),
        ("LAWS = [3]", "LAWS holds 3, which is not a DamageLaw"),
        ("import no_such_module", "line 1: ModuleNotFoundError: No module named 'no_such_module'"),
        ("x = 1\nx = (", "line 2: SyntaxError"),
        ("def f():\n    raise ValueError('a\\nb')\nf()", "line 2: ValueError: a b"),
        ("import sys\nsys.exit(3)", "line 2: SystemExit: 3"),
        (TEXT.replace('"nm"', '"inch"'), r'unit "inch" is unknown'),
        (TEXT.replace("*, thickness, wet", "*, thickness"), r"line \d+: ValueError: law \"film\""),
        (TEXT.replace('"film"', '"objective"'), "one of this name exists in the program itself"),
        ("\0", "."),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_in_one_line_with_its_name(
    text: str, message: str, file: Path
) -> None:
    file.write_text(text)
    with pytest.raises(SceneError, match=message) as raised:
        find_laws([file])
    line = str(raised.value)
    assert str(file) in line and "\n" not in line


def test_a_file_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"none\.py: cannot be read: No such file"):
        find_laws([tmp_path / "none.py"])
    with pytest.raises(SceneError, match="cannot be read: Is a directory"):
        find_laws([tmp_path])


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ("return None", r'law = "film" of .*my_law\.py returns NoneType, not RateConstants'),
        ("return 1 / 0", r'law = "film" of .* fails: ZeroDivisionError: division by zero'),
        ("interfaces.length[0] = 1.0", "fails: ValueError: assignment destination is read-only"),
    ],
)
def test_a_law_that_fails_is_refused_before_a_run_begins(
    wrong: str, message: str, file: Path
) -> None:
    file.write_text(TEXT.replace("return printed(interfaces, damage)", wrong))
    scene = load_scene_text("", "a.toml", CHOSEN, find_laws([file]))
    with pytest.raises(SceneError, match=message):
        refuse_faulty_laws(scene)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ("return start.no_such_thing", r"own_jump\" of .* fails: AttributeError: .*no_such_thing"),
        ("return 3.0", "own_jump\" of .* fails: AttributeError: 'float'"),
        ("yield 3.0", "own_jump\" of .* fails: AttributeError: 'float'"),
    ],
)
def test_a_cycle_jump_that_fails_is_refused_before_a_run_begins(
    wrong: str, message: str, file: Path
) -> None:
    file.write_text(TEXT.replace("return Euler(settings.delta_d)(start)", wrong))
    scene = load_scene_text("", "a.toml", CHOSEN, find_laws([file]))
    with pytest.raises(SceneError, match=message):
        refuse_faulty_laws(scene)


def install(folder: Path, text: str) -> None:
    """Make a package of laws and its metadata as pip does."""
    (folder / "my_laws.py").write_text(text)
    info = folder / "my_laws-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: my-laws\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[pearlite_petsc.laws]\nmine = my_laws\n")


def test_an_installed_package_adds_its_laws_by_an_entry_point(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(tmp_path, TEXT)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "my_laws", raising=False)
    scene = load_scene_text("", "a.toml", CHOSEN, find_laws())
    assert laws_of_scene(scene)[0]["file"] == "my_laws"
    assert laws_of_scene(scene)[0]["sha256"] == hashlib.sha256(TEXT.encode()).hexdigest()


def test_a_broken_package_stops_only_those_who_ask_for_its_laws(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(tmp_path, "import no_such_module")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "my_laws", raising=False)
    laws = find_laws()
    assert load_scene_text("", "a.toml", (), laws) == load_scene_text("", "a.toml")
    with pytest.raises(SceneError, match=r"entry point mine of my-laws 1\.0: ModuleNotFoundError"):
        load_scene_text("", "a.toml", ["damage.law=film"], laws)


def test_results_can_be_read_without_their_laws_but_not_computed(file: Path) -> None:
    scene = load_scene_text('name = "a"', "a.toml", CHOSEN, find_laws([file]))
    written = scene_to_toml(scene)
    found = load_scene_text(written, "a.toml", (), laws_of_results(written))
    assert scene_hash(found) == scene_hash(scene)
    assert laws_of_scene(found)[0]["parameters"] == {"thickness_nm": 50.0, "wet": True}
    with pytest.raises(PearliteError, match=r'law "film" was not loaded: --load the file with SHA'):
        refuse_faulty_laws(found)
    plain = scene_to_toml(load_scene_text("", "a.toml"))
    assert laws_of_results(plain) == SHIPPED
