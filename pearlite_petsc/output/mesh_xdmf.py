"""A mesh file for ParaView: an ``.xdmf`` that names the datasets of the ``.h5`` beside it."""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import h5py

from pearlite_petsc.output.mesh_file import POLYGONS
from pearlite_petsc.output.whole_file import whole_file

_OF_ELEMENTS = (
    "area_um2",
    "block",
    "colony",
    "lamella_angle_rad",
    "nucleus",
    "prior_austenite_grain",
)
_OF_INTERFACES = ("kind", "length_um")


def write_mesh_xdmf(mesh_file: Path) -> Path:
    """Write ``<stem>.xdmf`` beside a mesh file; return its path.

    It has two grids, ``elements`` (polygons) and ``interfaces`` (lines), with their datasets as
    cell fields. Nothing of the mesh is copied, so that both files belong together.

    Args:
        mesh_file: What ``write_mesh`` wrote.
    """
    root = ElementTree.Element("Xdmf", Version="2.0")
    domain = ElementTree.SubElement(root, "Domain")
    both = ElementTree.SubElement(
        domain, "Grid", Name="mesh", GridType="Collection", CollectionType="Spatial"
    )
    with h5py.File(mesh_file, "r") as file:
        elements = _grid(both, file, mesh_file.name, "elements")
        count = str(len(file["elements/offsets"]) - 1)
        topology = ElementTree.SubElement(
            elements, "Topology", TopologyType="Mixed", NumberOfElements=count
        )
        topology.append(_data(file, mesh_file.name, POLYGONS))
        _fields(elements, file, mesh_file.name, "elements", _OF_ELEMENTS)
        interfaces = _grid(both, file, mesh_file.name, "interfaces")
        count = str(len(file["interfaces/vertices"]))
        topology = ElementTree.SubElement(
            interfaces,
            "Topology",
            TopologyType="Polyline",
            NodesPerElement="2",
            NumberOfElements=count,
        )
        topology.append(_data(file, mesh_file.name, "interfaces/vertices"))
        _fields(interfaces, file, mesh_file.name, "interfaces", _OF_INTERFACES)
    path = mesh_file.with_suffix(".xdmf")
    ElementTree.indent(root)
    with whole_file(path) as partial:
        ElementTree.ElementTree(root).write(partial, encoding="utf-8", xml_declaration=True)
    return path


def _grid(parent: ElementTree.Element, file: Any, name: str, title: str) -> ElementTree.Element:
    grid = ElementTree.SubElement(parent, "Grid", Name=title, GridType="Uniform")
    geometry = ElementTree.SubElement(grid, "Geometry", GeometryType="XY")
    geometry.append(_data(file, name, "vertices_um"))
    return grid


def _fields(
    grid: ElementTree.Element, file: Any, name: str, group: str, fields: tuple[str, ...]
) -> None:
    for field in fields:
        attribute = ElementTree.SubElement(
            grid, "Attribute", Name=field, AttributeType="Scalar", Center="Cell"
        )
        attribute.append(_data(file, name, f"{group}/{field}"))


def _data(file: Any, name: str, dataset: str) -> ElementTree.Element:
    """Return the reference to a dataset of the mesh file."""
    array = file[dataset]
    item = ElementTree.Element(
        "DataItem",
        Dimensions=" ".join(map(str, array.shape)),
        NumberType="Float" if array.dtype.kind == "f" else "Int",
        Precision=str(array.dtype.itemsize),
        Format="HDF",
    )
    item.text = f"{name}:/{dataset}"
    return item
