"""XDMF time series through meshio, heavy data in an HDF5 file beside it.

meshio's own ``TimeSeriesWriter`` puts the HDF5 file into the working directory, knows one mesh,
numbers all datasets through, and shows that mesh as a second grid beside the series. Here the file
lies beside the ``.xdmf``, each step refers to the mesh it belongs to, every mesh is stored once, and
the ``.h5`` can be read without the ``.xdmf``: groups ``mesh_<i>`` and ``step_<j>``, datasets with
their fields' names, attributes ``unit`` and ``description``, and ``cycles`` and ``mesh`` of a step.
The ``.xdmf`` names the ``.h5`` relative to itself, so a copied folder opens.
"""

import copy
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import h5py
import meshio
import numpy as np
from meshio.xdmf import TimeSeriesWriter
from numpy.typing import NDArray

from pearlite_petsc.arrays import FloatArray, IntArray
from pearlite_petsc.output.safe_stream import SafeStream
from pearlite_petsc.output.whole_file import whole_file

FORMAT_VERSION = 2
"""Of the ``.h5``; 0.1.0 numbered its datasets and gave no version."""


class SeriesWriter(TimeSeriesWriter):  # type: ignore[misc]
    """One ``<name>.xdmf`` with ``<name>.h5``; both appear whole when the writer is closed.

    Args:
        path: The ``.xdmf``; its folder is made if need be.
        about: Unit and description of every field by its name, of ``points_um`` and ``cells`` too.
    """

    def __init__(self, path: Path, about: Mapping[str, tuple[str, str]]) -> None:
        super().__init__(path, data_format="HDF")
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path = path
        self.h5_filename = path.with_suffix(".h5").name
        self._partial = path.with_suffix(".h5.partial")
        # The newer file layout halves the time of many small datasets (HDF5 1.10 reads it).
        self._stream = SafeStream(self._partial)
        self.h5_file = h5py.File(self._stream, "w", libver="latest")
        self.h5_file.attrs["format_version"] = FORMAT_VERSION
        self._about = about
        self._mesh: list[ElementTree.Element] = []
        self._meshes = self._steps = 0
        self._names: list[str] = []

    def write_mesh(
        self,
        points: FloatArray,
        cell_type: str,
        cells: IntArray,
        cell_data: dict[str, NDArray[Any]],
    ) -> None:
        """Store the mesh of the steps that follow, and the fields that stay with it.

        Args:
            points: [um]; shape (p, 2) or (p, 3).
            cell_type: meshio's name, "triangle" or "line".
            cells: Points of each cell; shape (c, points of a cell).
            cell_data: Fields with the first axis of the cells, the same in every step.
        """
        self._group = self.h5_file.create_group(f"mesh_{self._meshes}")
        self._meshes += 1
        self._names = ["points_um", "cells", *cell_data]
        holder = ElementTree.Element("Grid")
        flat = np.zeros((len(points), 3))
        flat[:, : points.shape[1]] = points
        self.points(holder, flat)
        self.cells([meshio.CellBlock(cell_type, cells.astype(np.int32))], holder)
        topology = holder.find("Topology")
        if topology is not None:
            # A polyline has no number of points of its own, and meshio does not write it.
            topology.set("NodesPerElement", str(cells.shape[1]))
        self.cell_data({name: [values] for name, values in cell_data.items()}, holder)
        self._mesh = list(holder)

    def write_step(
        self,
        time: float,
        point_data: dict[str, NDArray[Any]],
        cell_data: dict[str, NDArray[Any]],
    ) -> None:
        """Store the fields of one time on the mesh written last.

        Args:
            time: N [cycles], larger than that of the step before.
            point_data: Fields with the first axis of the points.
            cell_data: Fields with the first axis of the cells; (c,), (c, 3) or (c, 9).

        Raises:
            OSError: The file cannot be written.
        """
        self._group = self.h5_file.create_group(f"step_{self._steps}")
        self._group.attrs["cycles"] = float(time)
        self._group.attrs["mesh"] = f"mesh_{self._meshes - 1}"
        self._steps += 1
        self._names = [*point_data, *cell_data]
        grid = ElementTree.SubElement(self.collection, "Grid", Name="step", GridType="Uniform")
        grid.extend(copy.deepcopy(self._mesh))
        ElementTree.SubElement(grid, "Time", Value=repr(float(time)))
        self.point_data(point_data, grid)
        self.cell_data({name: [values] for name, values in cell_data.items()}, grid)
        self._stream.check()

    def numpy_to_xml_string(self, data: NDArray[Any]) -> str:
        """Store an array under the next name of its group; meshio's hook, called in that order."""
        name = self._names.pop(0)
        dataset = self._group.create_dataset(name, data=data)
        dataset.attrs["unit"], dataset.attrs["description"] = self._about[name]
        return f"{self.h5_filename}:{dataset.name}"

    def close(self) -> None:
        """Finish both files."""
        self.h5_file.close()
        self._stream.close()
        self._stream.check()
        self._partial.replace(self.path.with_name(self.h5_filename))
        with whole_file(self.path) as partial:
            ElementTree.indent(self.xdmf_file)
            ElementTree.ElementTree(self.xdmf_file).write(
                partial, encoding="utf-8", xml_declaration=True
            )

    def abandon(self) -> None:
        """Remove what was written so far."""
        self.h5_file.close()
        self._stream.close()
        self._partial.unlink(missing_ok=True)
