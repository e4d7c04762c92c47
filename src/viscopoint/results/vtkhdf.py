"""One snapshot as a VTKHDF file (version 2.0, UnstructuredGrid), which ParaView and PyVista open.

Finite elements are hexahedra, or quadrilaterals of an axisymmetric body's half section; material points are vertices.
Each piece of data has a checksum, so that damage is found and not shown.
"""

import math
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from viscopoint.kernels.arrays import Indices
from viscopoint.model import memory
from viscopoint.model.method import Field
from viscopoint.results.hdf5 import FILTERS, opened, rows, written

KINDS = {1: 1, 4: 9, 8: 12}  # VTK's cell types by the number of corners: vertex, quadrilateral, hexahedron
DATA = {"points": "PointData", "cells": "CellData"}
COUNTS = {"points": "NumberOfPoints", "cells": "NumberOfCells"}
CHUNK = 16_384  # greatest number of rows compressed together


def write(path: Path, time: float, fields: Mapping[str, Field], cells: Indices) -> None:
    """Write all fields at a time [ms]; ``position`` is where the points are, ``cells[e, corner]`` may be none."""
    points = len(fields["position"].values)
    cells = cells if len(cells) else np.arange(points)[:, None]
    with written(path) as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([2, 0])
        root.attrs.create("Type", np.bytes_("UnstructuredGrid"), dtype=h5py.string_dtype("ascii", 16))
        for name, count in ((COUNTS["points"], points), (COUNTS["cells"], len(cells))):
            root[name] = np.array([count])
        root["NumberOfConnectivityIds"] = np.array([cells.size])
        _store(root, "Connectivity", cells.ravel())
        _store(root, "Offsets", np.arange(len(cells) + 1) * cells.shape[1])
        _store(root, "Types", np.full(len(cells), KINDS[cells.shape[1]], np.uint8))
        root.create_group("FieldData")["TimeValue"] = np.array([time])
        for group in DATA.values():
            root.create_group(group)
        for name, field in fields.items():
            place = (root, "Points") if name == "position" else (root[DATA[field.on]], name)
            _store(*place, field.values).attrs["unit"] = np.bytes_(field.unit)  # of fixed length: HDF5 checks that


def _store(group: Any, name: str, values: NDArray[Any]) -> Any:
    """Store an array in pieces of equal length."""
    count = max(len(values), 1)
    length = -(-count // -(-count // CHUNK))
    return group.create_dataset(name, data=values, chunks=(length, *values.shape[1:]), **FILTERS)


def read(path: Path, only: Collection[str] | None = None) -> dict[str, Field]:
    """Return all fields of a file, or ``only`` some as far as they are there; ``ValueError`` if it is damaged."""
    with opened(path) as file:
        root = file["VTKHDF"]
        found = {"position": (root["Points"], "points")}
        found |= {name: (data, on) for on, group in DATA.items() for name, data in root[group].items()}
        if only is not None:
            found = {name: place for name, place in found.items() if name in only}
        counts = {on: int(root[name][0]) for on, name in COUNTS.items()}
        ensure_memory(counts[on] * row_size(data) for data, on in found.values())
        return {name: _field(data, counts[on], on) for name, (data, on) in found.items()}


def _field(dataset: Any, count: int, on: Any) -> Field:
    if len(dataset) != count:
        raise ValueError(f"{dataset.name} is of another length")
    return Field(rows(dataset, 0, count), unit_of(dataset), on)


def unit_of(dataset: Any) -> str:
    """Return the unit of a dataset; empty where HDF5 may seek it forever if it is damaged (format 5)."""
    if dataset.attrs.get_id("unit").get_type().is_variable_str():
        return ""
    return bytes(dataset.attrs["unit"]).decode("ascii")


def row_size(dataset: Any) -> int:
    """Return what a row of a dataset takes [bytes]."""
    return math.prod(dataset.shape[1:]) * dataset.dtype.itemsize


def ensure_memory(sizes: Iterable[int]) -> None:
    """Raise ``ValueError`` where fields of these sizes [bytes] would not fit."""
    size, there = sum(sizes), memory.free()
    if size > there:
        raise ValueError(f"the snapshot takes {size / 2**30:.3g} GiB, there are {there / 2**30:.3g}")
