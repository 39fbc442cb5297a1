"""ParaView's own reader opens a mesh: polygons, lines and their fields."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from pearlite_petsc.output.mesh_file import write_mesh
from pearlite_petsc.output.mesh_xdmf import write_mesh_xdmf
from pearlite_petsc.tessellation.build import build_mesh
from pearlite_petsc.tessellation.mesh import Mesh
from tests.scenes import STATES, default_scene

vtk_xdmf = pytest.importorskip("vtkmodules.vtkIOXdmf2")
vtk_numpy = pytest.importorskip("vtkmodules.util.numpy_support")


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    scene = default_scene(window={"width": 60.0, "height": 50.0, "notch": 20.0})
    return build_mesh(scene, STATES["moderate_TA"], 3)


def opened(path: Path):
    reader = vtk_xdmf.vtkXdmfReader()
    reader.SetFileName(str(path))
    reader.Update()
    both = reader.GetOutputDataObject(0)
    assert both.GetNumberOfBlocks() == 2
    return both.GetBlock(0), both.GetBlock(1)


def field(grid, name: str) -> np.ndarray:
    return vtk_numpy.vtk_to_numpy(grid.GetCellData().GetArray(name))


def points_of(grid, number: int) -> np.ndarray:
    return vtk_numpy.vtk_to_numpy(grid.GetCell(number).GetPoints().GetData())[:, :2].copy()


def test_elements_are_their_polygons_with_their_fields(tmp_path: Path, mesh: Mesh) -> None:
    write_mesh(tmp_path / "mesh.h5", mesh, "")
    assert write_mesh_xdmf(tmp_path / "mesh.h5") == tmp_path / "mesh.xdmf"
    elements, _ = opened(tmp_path / "mesh.xdmf")
    assert elements.GetNumberOfCells() == mesh.element_count
    for number in range(mesh.element_count):
        corners = mesh.vertex_indices[mesh.offsets[number] : mesh.offsets[number + 1]]
        assert_array_equal(points_of(elements, number), mesh.vertices[corners])
    assert_array_equal(field(elements, "colony"), mesh.colony)
    assert_array_equal(field(elements, "prior_austenite_grain"), mesh.prior_austenite_grain)
    assert_allclose(field(elements, "lamella_angle_rad"), mesh.lamella_angle, rtol=0)
    assert field(elements, "area_um2").sum() == pytest.approx(60.0 * 50.0)


def test_interfaces_are_lines_with_their_kinds(tmp_path: Path, mesh: Mesh) -> None:
    write_mesh(tmp_path / "mesh.h5", mesh, "")
    _, interfaces = opened(write_mesh_xdmf(tmp_path / "mesh.h5"))
    assert interfaces.GetNumberOfCells() == mesh.interface_count
    assert_array_equal(field(interfaces, "kind"), mesh.kind)
    ends = np.array([points_of(interfaces, number) for number in range(mesh.interface_count)])
    assert_array_equal(ends, mesh.vertices[mesh.interface_vertices])


def test_both_files_can_be_moved_together(tmp_path: Path, mesh: Mesh) -> None:
    write_mesh(tmp_path / "here" / "mesh.h5", mesh, "")
    write_mesh_xdmf(tmp_path / "here" / "mesh.h5")
    shutil.move(tmp_path / "here", tmp_path / "there")
    elements, _ = opened(tmp_path / "there" / "mesh.xdmf")
    assert_array_equal(field(elements, "block"), mesh.block)
    assert sorted(path.name for path in (tmp_path / "there").iterdir()) == ["mesh.h5", "mesh.xdmf"]
