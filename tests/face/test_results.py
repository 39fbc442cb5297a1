"""A run from Python and its results read back: the same cracks as grown one by one."""

import csv
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot
from mpi4py import MPI

import pearlite_petsc as pp
from tests.face.scenes import small_scene


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("face") / "small"
    results = pp.run(small_scene(), folder, comm=MPI.COMM_SELF)
    assert len(results) == 8
    return folder


def test_a_run_has_the_cracks_that_grow_one_by_one(folder: Path) -> None:
    results = pp.read_results(folder)
    assert results.scene == small_scene()
    mesh = pp.build_mesh(results.scene, "severe_AT", index=1)
    alone = pp.grow_crack(mesh, delta_k_mpa_sqrt_m=18.0)
    found = results.crack("severe_AT", 1, delta_k_mpa_sqrt_m=18.0)
    assert found.da_dn_m_per_cycle == alone.da_dn_m_per_cycle
    assert found.history.cycles.tolist() == alone.history.cycles.tolist()
    assert found.path.y_um.tolist() == alone.path.y_um.tolist()


def test_the_table_of_cracks_is_that_of_the_file(folder: Path) -> None:
    cracks = pp.read_results(folder).cracks()
    with (folder / "fcg.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert list(cracks.columns) == list(rows[0])
    for row, crack in zip(rows, cracks, strict=True):
        for name, value in crack.items():
            text = row[name] or "nan"
            assert (
                text == value
                if isinstance(value, str)
                else str(value) == text
                or np.isclose(float(text), value, rtol=1e-14, equal_nan=True)
            )


def test_rates_are_geometric_means_over_the_meshes_that_grew(folder: Path) -> None:
    results = pp.read_results(folder)
    rates, cracks = results.rates(), results.cracks()
    assert len(rates) == 4
    for row in rates:
        own = (cracks.state == row["state"]) & (
            cracks.delta_k_mpa_sqrt_m == row["delta_k_mpa_sqrt_m"]
        )
        grown = cracks.da_dn_m_per_cycle[own & (cracks.stop_reason == "grown")]
        assert (row["grown"], row["meshes"]) == (len(grown), 2)
        if len(grown):
            assert row["da_dn_m_per_cycle"] == pytest.approx(np.exp(np.log(grown).mean()))
        else:
            assert np.isnan(row["da_dn_m_per_cycle"])
    assert (rates.grown == 2).any()
    assert (rates.grown == 0).any()


def test_paths_are_those_of_the_cracks(folder: Path) -> None:
    results = pp.read_results(folder)
    paths = results.paths()
    assert len(paths) == sum(len(crack.path) for crack in results)
    own = (paths.state == "undeformed") & (paths.mesh == 0) & (paths.delta_k_mpa_sqrt_m == 18.0)
    crack = results.crack("undeformed", delta_k_mpa_sqrt_m=18.0)
    assert paths.x_um[own].tolist() == crack.path.x_um.tolist()


def test_the_file_and_the_bare_tables_give_the_same_rates(folder: Path, tmp_path: Path) -> None:
    whole = pp.read_results(folder)
    assert pp.read_results(folder / "results.h5").rates().to_dict().keys() == (
        whole.rates().to_dict().keys()
    )
    for name in ("fcg.csv", "scene.resolved.toml"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    bare = pp.read_results(tmp_path)
    assert bare.provenance == {}
    assert bare.rates().da_dn_m_per_cycle == pytest.approx(
        whole.rates().da_dn_m_per_cycle, rel=1e-12, nan_ok=True
    )
    assert len(bare.paths()) == 0
    crack = bare.crack("severe_AT", delta_k_mpa_sqrt_m=18.0)
    assert len(crack.rates) == len(crack.history) == 0
    with pytest.raises(pp.PearliteError, match="has no path to draw"):
        crack.plot()


@pytest.mark.parametrize(
    ("state", "index", "delta_k", "message"),
    [
        ("severe_at", 0, 18.0, "did you mean severe_AT?"),
        ("severe_AT", 7, 18.0, "no crack of severe_AT, mesh 7, at 18 MPa sqrt(m); meshes are 0, 1"),
        ("severe_AT", 0, 17.0, "at 17 MPa sqrt(m); meshes are 0, 1, at 4, 18"),
    ],
)
def test_a_crack_that_is_not_there_is_refused(
    folder: Path, state: str, index: int, delta_k: float, message: str
) -> None:
    with pytest.raises(pp.PearliteError) as refused:
        pp.read_results(folder).crack(state, index, delta_k_mpa_sqrt_m=delta_k)
    assert message in str(refused.value)


def test_a_folder_without_results_is_refused(tmp_path: Path) -> None:
    with pytest.raises(pp.PearliteError, match="no results here"):
        pp.read_results(tmp_path)
    with pytest.raises(pp.PearliteError, match="nothing.h5: no such file"):
        pp.read_results(tmp_path / "nothing.h5")


def test_a_finished_run_is_refused_twice_and_resumed(folder: Path) -> None:
    with pytest.raises(pp.PearliteError):
        pp.run(small_scene(), folder, comm=MPI.COMM_SELF)
    again = pp.run(small_scene(), folder, resume=True, comm=MPI.COMM_SELF)
    assert len(again) == 8


def test_rates_draw_themselves(folder: Path) -> None:
    results = pp.read_results(folder)
    _, given = pyplot.subplots()
    assert results.plot(given) is given
    axes = results.plot()
    assert axes.get_ylabel() == "da/dN [m/cycle]"
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels[:2] == ["undeformed", "severe A-T"]
    pyplot.close("all")


def test_the_text_counts_the_cracks_by_how_they_ended(folder: Path) -> None:
    text = repr(pp.read_results(folder))
    assert text.startswith(f"<Results of {folder}: 8 cracks, ")
    assert "grown" in text


LAW = """
from dataclasses import replace

from pearlite_petsc.fatigue.damage import objective
from pearlite_petsc.laws import DamageLaw


def twice(interfaces, damage):
    constants = objective(interfaces, damage)
    return replace(constants, factor=2.0 * constants.factor)


LAWS = [DamageLaw(name="twice", help="twice as fast", function=twice)]
"""


def test_results_with_a_law_of_ones_own_are_read_without_it_and_go_on_with_it(
    tmp_path: Path, folder: Path
) -> None:
    law = tmp_path / "law.py"
    law.write_text(LAW)
    tables = small_scene().to_dict() | {"damage": {"law": "twice"}, "ensemble": {"meshes": 1}}
    tables["states"] = {"severe_AT": {}}
    scene = pp.Scene.from_dict(tables, load=law)
    results = pp.run(scene, tmp_path / "run", comm=MPI.COMM_SELF)
    found = results.crack("severe_AT", delta_k_mpa_sqrt_m=18.0)
    slower = pp.read_results(folder).crack("severe_AT", delta_k_mpa_sqrt_m=18.0)
    assert found.da_dn_m_per_cycle == pytest.approx(2.0 * slower.da_dn_m_per_cycle, rel=1e-9)
    mesh = pp.build_mesh(results.scene, "severe_AT")
    again = pp.grow_crack(mesh, delta_k_mpa_sqrt_m=18.0)
    assert again.da_dn_m_per_cycle == found.da_dn_m_per_cycle
    bare = pp.read_results(tmp_path / "run")
    assert bare.scene["damage"]["law"] == "twice"
    with pytest.raises(pp.PearliteError, match='law "twice" was not loaded'):
        pp.grow_crack(pp.build_mesh(bare.scene, "severe_AT"), delta_k_mpa_sqrt_m=18.0)
    whole = pp.read_results(tmp_path / "run", load=law)
    assert whole.scene.replace(ensemble={"meshes": 3})["damage"]["law"] == "twice"
    law.write_text(LAW.replace("2.0", "3.0"))
    with pytest.raises(pp.PearliteError, match="law"):
        pp.read_results(tmp_path / "run", load=law)
