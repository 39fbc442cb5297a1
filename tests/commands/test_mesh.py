"""The mesh command, and the recipes of meshes/ that it is made for."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import pearlite_petsc as pp
from pearlite_petsc.mesh import main
from pearlite_petsc.output.mesh_file import read_mesh, read_recipe

ROOT = Path(__file__).parents[2]
SCENE_FILE = str(ROOT / "runs" / "quickstart.toml")
RECIPES = sorted((ROOT / "meshes").glob("*.toml"))


def run(
    tmp_path: Path,
    *extra: str,
    state: str = "severe_AT",
    index: str = "1",
    output: str = "mesh.h5",
) -> int:
    arguments = [SCENE_FILE, "--state", state, "--index", index]
    return main([*arguments, "--output", str(tmp_path / output), *extra])


def test_the_command_writes_the_mesh_that_the_scene_gives(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path) == 0
    mesh = read_mesh(tmp_path / "mesh.h5")
    assert (mesh.state, mesh.index) == ("severe_AT", 1)
    assert "severe_AT" in read_recipe(tmp_path / "mesh.h5")
    text = capsys.readouterr().out
    for words in ("prior austenite grain", "target", f"elements {mesh.element_count}", "notch tip"):
        assert words in text
    wrote = [f"wrote {tmp_path / name}" for name in ("mesh.h5", "mesh.xdmf")]
    assert text.splitlines()[-2:] == wrote


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"state": "sever_AT"}, "did you mean severe_AT"),
        ({"index": "-1"}, "-1 is negative"),
        ({"output": "mesh.vtk"}, "mesh.vtk: a mesh is an HDF5 file, such as severe_AT_m1.h5"),
    ],
)
def test_the_command_refuses_bad_input_with_one_message(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    changes: dict[str, str],
    message: str,
) -> None:
    assert run(tmp_path, **changes) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_the_command_replaces_a_file_only_when_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("mesh.h5", "mesh.xdmf"):
        (tmp_path / name).write_text("mine")
        assert run(tmp_path) == 2
        assert f"{name} exists; --overwrite" in capsys.readouterr().err
        assert (tmp_path / name).read_text() == "mine"
        (tmp_path / name).unlink()
    (tmp_path / "mesh.h5").write_text("mine")
    assert run(tmp_path, "--overwrite") == 0
    assert read_mesh(tmp_path / "mesh.h5").state == "severe_AT"


def test_a_scene_of_several_states_asks_for_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([SCENE_FILE, "--output", str(tmp_path / "mesh.h5")]) == 2
    assert "has 5 states, choose by --state: undeformed, moderate_AT" in capsys.readouterr().err


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda path: path.stem)
def test_a_recipe_gives_a_mesh_beside_itself(
    recipe: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copy(recipe, tmp_path)
    assert main([str(tmp_path / recipe.name), "--index", "2"]) == 0
    mesh = read_mesh(tmp_path / f"{recipe.stem}_m2.h5")
    assert (mesh.state, mesh.index) == (recipe.stem, 2)
    assert (tmp_path / f"{recipe.stem}_m2.xdmf").is_file()
    assert "wrote" in capsys.readouterr().out


def test_the_recipes_are_the_five_states_of_the_source_with_four_meshes_each() -> None:
    source = pp.load_scene(ROOT / "runs" / "source.toml")
    assert {path.stem for path in RECIPES} == set(source.states)
    for path in RECIPES:
        recipe = pp.load_scene(path)
        assert recipe.states == {path.stem: source.states[path.stem]}
        assert recipe["ensemble"]["meshes"] == 4
        for table in ("microstructure", "window"):
            assert recipe[table] == source[table]
        left_out = {"radius_um"}  # of another refinement
        ours, theirs = (
            {key: value for key, value in scene["elements"].items() if key not in left_out}
            for scene in (recipe, source)
        )
        assert ours == theirs


def test_a_recipe_has_the_nuclei_of_a_run_where_both_are_fine() -> None:
    scene = pp.load_scene(ROOT / "meshes" / "severe_AT.toml")
    corridor = pp.build_mesh(scene, "severe_AT", index=1).elements
    followed = scene.replace(elements={"refinement": "follow"})
    start = pp.build_mesh(followed, "severe_AT", index=1).elements
    places, numbers = (np.column_stack([t.x_um, t.y_um]) for t in (corridor, start))
    fine = {tuple(place) for place in numbers[start.fine].tolist()}
    assert len(fine) > 50
    assert fine <= {tuple(place) for place in places[corridor.fine].tolist()}


@pytest.mark.parametrize("output", ["file/mesh.h5", "folder.h5"])
def test_a_place_that_cannot_be_written_is_one_message(
    output: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder.h5").mkdir()
    recipe = str(ROOT / "meshes" / "severe_AT.toml")
    assert main([recipe, "--output", str(tmp_path / output), "--overwrite"]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert "cannot be used as output" in err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder.h5"]
