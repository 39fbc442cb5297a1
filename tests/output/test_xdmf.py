import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from pearlite_petsc.fatigue.outcome import GrowthState
from pearlite_petsc.output.xdmf import FieldSeries
from tests.output import synthetic
from tests.scenes import default_scene

vtk_xdmf = pytest.importorskip("vtkmodules.vtkIOXdmf2")
vtk_numpy = pytest.importorskip("vtkmodules.util.numpy_support")


def scene(steps: int = 8):
    return default_scene(loading={"extension": 48.0}, output={"field_steps": steps})


def written(folder: Path, states: list[GrowthState], steps: int = 8) -> Path:
    with FieldSeries(folder / "fields", "undeformed_m0_dk8", scene(steps), steps) as series:
        for state in states:
            series.add(state)
    return folder / "fields" / "undeformed_m0_dk8_elements.xdmf"


def opened(path: Path):
    reader = vtk_xdmf.vtkXdmfReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    key = reader.GetExecutive().TIME_STEPS()
    times = reader.GetOutputInformation(0).Get(key)
    return reader, ([] if times is None else list(times))


def at(reader, time: float):
    reader.UpdateTimeStep(time)
    return reader.GetOutputDataObject(0)


def array(data, name: str) -> np.ndarray:
    values = data.GetArray(name)
    assert values is not None, name
    return vtk_numpy.vtk_to_numpy(values)


def corners(grid) -> np.ndarray:
    points = vtk_numpy.vtk_to_numpy(grid.GetPoints().GetData())
    cells = vtk_numpy.vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    return points, cells.reshape(grid.GetNumberOfCells(), -1)


@pytest.fixture
def states() -> list[GrowthState]:
    return synthetic.growth_states(synthetic.voronoi_mesh(), 6)


def test_paraviews_reader_finds_every_step_and_the_fields_of_the_last_state(
    tmp_path: Path, states: list[GrowthState]
) -> None:
    path = written(tmp_path, states)
    reader, times = opened(path)
    assert times == [state.cycles for state in states]
    grid = at(reader, times[-1])
    mesh, last = states[-1].mesh, states[-1]
    assert grid.GetNumberOfCells() == len(mesh.vertex_indices) - 2 * mesh.element_count
    assert grid.GetNumberOfPoints() == len(mesh.vertex_indices)
    element = array(grid.GetCellData(), "element")
    for name in ("colony", "block", "prior_austenite_grain", "lamella_angle_rad"):
        wanted = getattr(mesh, name.removesuffix("_rad"))[element]
        assert_allclose(array(grid.GetCellData(), name), wanted, rtol=1e-6)
    assert array(grid.GetCellData(), "stress_mpa").shape == (grid.GetNumberOfCells(), 9)
    mean = array(grid.GetCellData(), "mean_damage")
    touching = np.any(mesh.interface_elements == 5, axis=1) & (mesh.kind != 5)
    wanted = np.average(last.damage[touching], weights=mesh.length[touching])
    assert_allclose(mean[element == 5], wanted, rtol=1e-6)


def test_interfaces_are_lines_with_their_own_fields(
    tmp_path: Path, states: list[GrowthState]
) -> None:
    path = written(tmp_path, states)
    reader, times = opened(path.with_name("undeformed_m0_dk8_interfaces.xdmf"))
    assert times == [state.cycles for state in states]
    for time, state in zip(times, states, strict=True):
        grid = at(reader, time)
        assert grid.GetNumberOfCells() == state.mesh.interface_count
        assert grid.GetCellType(0) in (3, 4)
        points, cells = corners(grid)
        ends = points[cells][:, :, :2]
        assert_allclose(ends.mean(axis=1), state.mesh.midpoint, atol=1e-9)
        data = grid.GetCellData()
        assert_allclose(array(data, "damage"), state.damage, rtol=1e-6)
        assert_array_equal(array(data, "kind"), state.mesh.kind)
        assert_allclose(array(data, "normal_stress_range_mpa"), state.normal_stress, rtol=1e-6)
        assert_allclose(array(data, "shear_stress_range_mpa"), state.shear_stress, rtol=1e-6)
        assert_array_equal(array(data, "failure_cycles"), state.failure_cycles)
        assert array(data, "broken").sum() == state.crack.broken


def test_warped_triangles_keep_their_size_and_stay_together_within_an_element(
    tmp_path: Path, states: list[GrowthState]
) -> None:
    reader, times = opened(written(tmp_path, states))
    mesh, last = states[-1].mesh, states[-1]
    grid = at(reader, times[-1])
    points, cells = corners(grid)
    element = array(grid.GetCellData(), "element")
    shift = array(grid.GetPointData(), "displacement_um").astype(float)
    assert np.abs(shift).max() > 1.0
    # Linear in theta: a rotation lengthens every line by a factor of sqrt(1 + theta^2).
    stretch = np.sqrt(1.0 + last.displacement[element, 2] ** 2)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        before = np.linalg.norm(points[cells[:, a]] - points[cells[:, b]], axis=1)
        after = np.linalg.norm(
            (points + shift)[cells[:, a]] - (points + shift)[cells[:, b]], axis=1
        )
        assert_allclose(after, before * stretch, rtol=1e-5, atol=1e-5)
    centre = mesh.centre[element]
    arm = points[cells[:, 1], :2] - centre
    motion = last.displacement[element]
    wanted = motion[:, :2] + motion[:, 2:] * np.stack([-arm[:, 1], arm[:, 0]], axis=1)
    assert_allclose(shift[cells[:, 1], :2], wanted, atol=1e-5)


def test_a_copied_folder_opens_from_any_working_directory(
    tmp_path: Path, states: list[GrowthState], monkeypatch: pytest.MonkeyPatch
) -> None:
    before = Path.cwd()
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    path = written(tmp_path / "result", states)
    assert os.listdir(elsewhere) == []
    assert not list(path.parent.glob("*.partial"))
    copied = tmp_path / "copy with spaces"
    shutil.copytree(path.parent, copied)
    shutil.rmtree(tmp_path / "result")
    monkeypatch.chdir(before)
    reader, times = opened(copied / path.name)
    assert at(reader, times[2]).GetNumberOfCells() > 0
    assert str(tmp_path) not in (copied / path.name).read_text()


def test_a_mesh_is_stored_once_and_a_new_one_takes_its_place(tmp_path: Path) -> None:
    coarse, fine = synthetic.voronoi_mesh(), synthetic.voronoi_mesh(10, 10, 8.0, seed=2)
    states = [*synthetic.growth_states(coarse, 3)]
    for state in synthetic.growth_states(fine, 5)[3:]:
        states.append(state)
    path = written(tmp_path, states, steps=40)
    reader, times = opened(path)
    assert len(times) == 5
    counts = [at(reader, time).GetNumberOfPoints() for time in times]
    assert counts == [len(coarse.vertex_indices)] * 3 + [len(fine.vertex_indices)] * 2
    text = path.read_text()
    references = [line for line in text.splitlines() if "_elements.h5:/mesh_0/points_um<" in line]
    assert len(references) == 3


@pytest.mark.parametrize("steps", [1, 2, 4, 7])
def test_no_more_steps_than_asked_for_and_the_last_state_is_among_them(
    tmp_path: Path, steps: int
) -> None:
    states = synthetic.growth_states(synthetic.voronoi_mesh(24, 24, 4.0), 14)
    _, times = opened(written(tmp_path, states, steps))
    assert 1 <= len(times) <= steps
    assert times[-1] == states[-1].cycles
    if steps > 1:
        assert times[0] == 0.0
        assert len(times) >= min(steps, 4)


def test_an_error_on_the_way_leaves_no_half_written_series(
    tmp_path: Path, states: list[GrowthState]
) -> None:
    series = FieldSeries(tmp_path, "a", scene(), 3)

    def broken() -> None:
        with series:
            series.add(states[0])
            raise ValueError("solver")

    with pytest.raises(ValueError, match="solver"):
        broken()
    assert list(tmp_path.iterdir()) == []
