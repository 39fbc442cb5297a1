"""Where the run command finds the measured points that a scene names."""

from pathlib import Path

import pytest

from pearlite_petsc.config import load_scene, scene_to_toml
from pearlite_petsc.errors import SceneError
from pearlite_petsc.output.results import write_results
from pearlite_petsc.run import _scene
from pearlite_petsc.run_options import parse_run

PRESET = Path(__file__).parents[2] / "runs" / "quickstart.toml"


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


POINTS = "state,delta_k_mpa_sqrt_m,da_dn_m_per_cycle\nsevere_AT,13,1.5e-9\n"


def experiment_of(*arguments: str) -> tuple[str, str | None]:
    """Return the scene's experiment and the text of its points, as the run would take them."""
    scene, experiment = _scene(parse_run(arguments)[0])
    return scene.output.experiment or "", experiment and experiment.text


def test_an_experiment_lies_beside_its_scene_or_in_the_working_directory(tmp_path: Path) -> None:
    (tmp_path / "project").mkdir()
    scene = tmp_path / "project" / "a.toml"
    scene.write_text('[output]\nexperiment = "points.csv"\n')
    (tmp_path / "points.csv").write_text(POINTS)
    assert experiment_of("project/a.toml") == ("points.csv", POINTS)
    (tmp_path / "project" / "points.csv").write_text(POINTS.replace("13", "14"))
    assert experiment_of("project/a.toml")[1] == POINTS.replace("13", "14")
    given = experiment_of("project/a.toml", "--set", "output.experiment=points.csv")
    assert given == ("points.csv", POINTS)


def test_results_bring_their_measured_points_along(tmp_path: Path) -> None:
    text = scene_to_toml(load_scene(PRESET, ["output.experiment=gone.csv"]))
    write_results(tmp_path / "new.h5", text, [], {}, POINTS)
    assert experiment_of("new.h5")[1] == POINTS
    (tmp_path / "other.csv").write_text(POINTS.replace("13", "14"))
    other = experiment_of("new.h5", "--set", "output.experiment=other.csv")
    assert other[1] == POINTS.replace("13", "14")
    write_results(tmp_path / "old.h5", text, [], {})
    with pytest.raises(SceneError, match=r"gone\.csv: measured points cannot be read"):
        experiment_of("old.h5")
