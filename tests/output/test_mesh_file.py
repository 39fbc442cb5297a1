from pathlib import Path

import h5py
import numpy as np
import pytest

from pearlite_petsc.errors import MeshError
from pearlite_petsc.output.mesh_file import read_mesh, read_recipe, write_mesh
from pearlite_petsc.tessellation.build import build_mesh
from pearlite_petsc.tessellation.mesh import Mesh
from tests.scenes import STATES, default_scene

OLD = Path(__file__).parent / "version_0_1_0" / "mesh.h5"


def small() -> Mesh:
    scene = default_scene(window={"width": 60.0, "height": 50.0, "notch": 20.0})
    return build_mesh(scene, STATES["moderate_TA"], 3)


def test_a_mesh_comes_back_bit_for_bit(tmp_path: Path) -> None:
    mesh = small()
    write_mesh(tmp_path / "new" / "mesh.h5", mesh, "a = 1\n")
    back = read_mesh(tmp_path / "new" / "mesh.h5")
    for name in Mesh.__slots__:
        first, second = getattr(mesh, name), getattr(back, name)
        if isinstance(first, np.ndarray):
            assert np.array_equal(first, second)
            assert first.dtype == second.dtype
        else:
            assert first == second
    assert read_recipe(tmp_path / "new" / "mesh.h5") == "a = 1\n"
    assert not list(tmp_path.rglob("*.partial"))


def test_the_file_has_the_documented_datasets_with_units(tmp_path: Path) -> None:
    mesh = small()
    write_mesh(tmp_path / "mesh.h5", mesh, "")
    n, k, m = mesh.element_count, mesh.interface_count, len(mesh.vertices)
    q = len(mesh.boundary_elements)
    shapes = {
        "vertices_um": (m, 2),
        "elements/centre_um": (n, 2),
        "elements/area_um2": (n,),
        "elements/offsets": (n + 1,),
        "elements/vertex_indices": mesh.vertex_indices.shape,
        "elements/colony": (n,),
        "elements/block": (n,),
        "elements/prior_austenite_grain": (n,),
        "elements/lamella_angle_rad": (n,),
        "interfaces/elements": (k, 2),
        "interfaces/vertices": (k, 2),
        "interfaces/length_um": (k,),
        "interfaces/midpoint_um": (k, 2),
        "interfaces/normal": (k, 2),
        "interfaces/kind": (k,),
        "boundary/elements": (q,),
        "boundary/vertices": (q, 2),
    }
    with h5py.File(tmp_path / "mesh.h5") as file:
        for name, shape in shapes.items():
            assert file[name].shape == shape
        found: list[h5py.Dataset] = []
        file.visititems(
            lambda _, item: found.append(item) if isinstance(item, h5py.Dataset) else None
        )
        assert all(d.attrs["unit"] and d.attrs["description"] for d in found)
        assert set(file.attrs) == {
            "recipe",
            "seed",
            "state",
            "index",
            "window_um",
            "notch_um",
            "format_version",
        }


def test_a_mesh_of_version_0_1_0_is_read() -> None:
    mesh = read_mesh(OLD)
    assert (mesh.state, mesh.index, mesh.window) == ("moderate_TA", 1, (24.0, 24.0))
    assert mesh.area.sum() == pytest.approx(24.0 * 24.0, rel=1e-12)
    assert "width_um = 24.0" in read_recipe(OLD)


def test_missing_truncated_and_foreign_files_are_refused_with_their_name(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match=r"none\.h5"):
        read_mesh(tmp_path / "none.h5")
    whole = tmp_path / "mesh.h5"
    write_mesh(whole, small(), "")
    (tmp_path / "half.h5").write_bytes(whole.read_bytes()[:3000])
    with pytest.raises(MeshError, match=r"half\.h5"):
        read_mesh(tmp_path / "half.h5")
    with h5py.File(whole, "r+") as file:
        file.attrs["format_version"] = 99
    with pytest.raises(MeshError, match="format 99 is not 2"):
        read_mesh(whole)
