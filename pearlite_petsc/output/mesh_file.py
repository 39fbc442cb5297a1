"""Mesh file: one mesh with its recipe in one HDF5 file."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from pearlite_petsc.arrays import IntArray
from pearlite_petsc.errors import MeshError
from pearlite_petsc.output.safe_stream import hdf5_file
from pearlite_petsc.output.whole_file import whole_file
from pearlite_petsc.scene import Kind
from pearlite_petsc.tessellation.mesh import Mesh

FORMAT_VERSION = 2
FIRST_FORMAT = 1
"""Of version 0.1.0: datasets without their unit at the end of the name."""

_KINDS = "0 lamella, 1 cementite, 2 colony, 3 block, 4 prior_austenite_grain, 5 notch"

# Field of the mesh: dataset, unit, description.
_DATASETS: dict[str, tuple[str, str, str]] = {
    "vertices": ("vertices_um", "um", "corners of the elements, x and y"),
    "junction": ("junction", "1", "vertices of one junction are ends of facets too short to count"),
    "centre": ("elements/centre_um", "um", "nucleus of each element, x and y"),
    "area": ("elements/area_um2", "um^2", "area of each element"),
    "offsets": ("elements/offsets", "1", "polygon i is vertex_indices[offsets[i]:offsets[i+1]]"),
    "vertex_indices": ("elements/vertex_indices", "1", "corners, counter-clockwise"),
    "colony": ("elements/colony", "1", "number of the colony"),
    "block": ("elements/block", "1", "number of the block"),
    "prior_austenite_grain": (
        "elements/prior_austenite_grain",
        "1",
        "number of the prior austenite grain",
    ),
    "lamella_angle": (
        "elements/lamella_angle_rad",
        "rad",
        "direction of the lamellae from the x axis",
    ),
    "nucleus": ("elements/nucleus", "1", "number of the nucleus in the uniformly fine mesh"),
    "fine": ("elements/fine", "1", "whether the element belongs to the fine zone"),
    "interface_elements": ("interfaces/elements", "1", "the two elements, i < j"),
    "interface_vertices": ("interfaces/vertices", "1", "the two end vertices"),
    "length": ("interfaces/length_um", "um", "length of each interface"),
    "midpoint": ("interfaces/midpoint_um", "um", "midpoint, x and y"),
    "normal": ("interfaces/normal", "1", "unit normal from element i to element j"),
    "kind": ("interfaces/kind", "1", _KINDS),
    "cementite_share": ("interfaces/cementite_share", "1", "share of the length across cementite"),
    "boundary_elements": ("boundary/elements", "1", "element of each facet of the window's edge"),
    "boundary_vertices": ("boundary/vertices", "1", "end vertices, counter-clockwise"),
}

POLYGONS = "elements/xdmf_polygons"
"""The polygons once more, as XDMF wants them: 3 (a polygon), number of corners, corners."""


def write_mesh(path: Path, mesh: Mesh, scene_text: str) -> None:
    """Write a mesh; the file appears whole and replaces an older one.

    Args:
        path: HDF5 file.
        mesh: What to write.
        scene_text: The scene it was made from (TOML).
    """
    with whole_file(path) as partial, hdf5_file(partial) as file:
        file.attrs["format_version"] = FORMAT_VERSION
        file.attrs["recipe"] = scene_text
        file.attrs["seed"] = mesh.seed
        file.attrs["state"] = mesh.state
        file.attrs["index"] = mesh.index
        file.attrs["window_um"] = mesh.window
        file.attrs["notch_um"] = mesh.notch
        for field, (name, unit, description) in _DATASETS.items():
            dataset = file.create_dataset(name, data=getattr(mesh, field))
            dataset.attrs["unit"] = unit
            dataset.attrs["description"] = description
        polygons = file.create_dataset(POLYGONS, data=_xdmf_polygons(mesh))
        polygons.attrs["unit"] = "1"
        polygons.attrs["description"] = "of each polygon 3, number of corners, corners; for XDMF"


def _xdmf_polygons(mesh: Mesh) -> IntArray:
    corners = np.diff(mesh.offsets)
    heads = np.column_stack([np.full(len(corners), 3, dtype=np.int64), corners])
    return np.insert(mesh.vertex_indices, np.repeat(mesh.offsets[:-1], 2), heads.ravel())


def read_mesh(path: Path) -> Mesh:
    """Return what `write_mesh` wrote, bit for bit; files of 0.1.0, too.

    Raises:
        MeshError: The file is missing, is no mesh file or has another format.
    """
    try:
        with h5py.File(path, "r") as file:
            version = int(file.attrs["format_version"])
            if version not in (FIRST_FORMAT, FORMAT_VERSION):
                raise MeshError(f"{path}: format {version} is not {FORMAT_VERSION}")
            fields: dict[str, Any] = {
                field: np.asarray(file[_name(field, version)][()])
                for field in _DATASETS
                if field != "cementite_share"
            }
            share = file.get(_DATASETS["cementite_share"][0])
            # Version 0.1.0 wrote kinds only, and knew no mixed interfaces.
            known = fields["kind"] == Kind.CEMENTITE if share is None else share[()]
            fields["cementite_share"] = np.asarray(known, dtype=np.float64)
            return Mesh(
                **fields,
                window=_pair(file.attrs["window_um"]),
                notch=_pair(file.attrs["notch_um"]),
                state=str(file.attrs["state"]),
                index=int(file.attrs["index"]),
                seed=int(file.attrs["seed"]),
            )
    except (OSError, KeyError, ValueError, TypeError) as error:
        raise MeshError(f"{path}: cannot be read as a mesh ({error})") from None


def read_recipe(path: Path) -> str:
    """Return the scene (TOML) that a mesh file was made from.

    Raises:
        MeshError: The file is missing or is no mesh file.
    """
    try:
        with h5py.File(path, "r") as file:
            return str(file.attrs["recipe"])
    except (OSError, KeyError) as error:
        raise MeshError(f"{path}: cannot be read as a mesh ({error})") from None


def _name(field: str, version: int) -> str:
    name, unit, _ = _DATASETS[field]
    return name.removesuffix("_" + unit.replace("^", "")) if version == FIRST_FORMAT else name


def _pair(values: Any) -> tuple[float, float]:
    first, second = values
    return float(first), float(second)
