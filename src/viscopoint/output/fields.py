"""``fields.vtkhdf``: all fields at each snapshot, one file that ParaView and PyVista open as an animation.

Temporal VTKHDF 2.3 of type UnstructuredGrid: finite elements as hexahedra, or quadrilaterals of an axisymmetric body's
half section; material points as vertices. The cells are stored once; positions and fields are appended, each snapshot
as a whole or not at all (``transaction``), with a checksum of every piece, so that damage is found and not shown.
"""

import contextlib
import errno
import os
import shutil
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from viscopoint.arrays import Indices
from viscopoint.body import Body
from viscopoint.method import Field
from viscopoint.output import offer
from viscopoint.transaction import change, reading

NAME = "fields.vtkhdf"
INITIAL = "initial_position"  # stored once, for all snapshots
KINDS = {1: 1, 4: 9, 8: 12}  # VTK's cell types by the number of corners: vertex, quadrilateral, hexahedron
DATA = {"points": "PointData", "cells": "CellData"}
CHUNK = 16_384  # greatest number of rows compressed together
RESERVE = 2**20  # bytes beside the raw size of a snapshot: HDF5's own, history and summary
LAYOUT = ("v110", "v110")  # of HDF5: the first with checksums of all that is not data
FILTERS: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True, "fletcher32": True}


@offer
class Fields:
    """Appends snapshots; the file is closed in between."""

    def __init__(self, folder: Path, body: Body, mark: int | None) -> None:
        self.path, self.cells, self.count = folder / NAME, body.cells, mark or 0
        if mark is None:
            self.path.unlink(missing_ok=True)
        else:
            with _changed(self.path) as file:
                _rewind(file["VTKHDF"], mark)

    def row(self, row: Any) -> None:
        pass

    def snapshot(self, time: float, fields: Mapping[str, Field]) -> None:
        _ensure_space(self.path.parent, sum(field.values.nbytes for field in fields.values()))
        with _changed(self.path) as file:
            if "VTKHDF" not in file:
                _begin(file, fields, self.cells)
            _append(file["VTKHDF"], time, fields)
        self.count += 1

    def mark(self) -> int:
        return self.count

    def close(self) -> None:
        pass


def _ensure_space(folder: Path, size: int) -> None:
    """Raise ``OSError`` where a snapshot may not fit, before it is compressed."""
    if shutil.disk_usage(folder).free < size + RESERVE:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def _begin(file: Any, fields: Mapping[str, Field], cells: Indices) -> None:
    """Create the file's groups, the cells and what never changes."""
    root = file.create_group("VTKHDF")
    root.attrs["Version"] = np.array([2, 3])
    root.attrs.create("Type", np.bytes_("UnstructuredGrid"), dtype=h5py.string_dtype("ascii", 16))
    points = len(fields["position"].values)
    cells = cells if len(cells) else np.arange(points)[:, None]
    for name, count in (("NumberOfPoints", points), ("NumberOfCells", len(cells))):
        root[name] = np.array([count])
    root["NumberOfConnectivityIds"] = np.array([cells.size])
    _whole(root, "Connectivity", cells.ravel())
    _whole(root, "Offsets", np.arange(len(cells) + 1) * cells.shape[1])
    _whole(root, "Types", np.full(len(cells), KINDS[cells.shape[1]], np.uint8))
    _growing(root, "Points", fields["position"])
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = 0
    for name, kind in (("Values", float), ("PartOffsets", int), ("NumberOfParts", int), ("PointOffsets", int)):
        steps.create_dataset(name, (0,), kind, maxshape=(None,))
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        steps.create_dataset(name, (0, 1), int, maxshape=(None, 1))
    for group in DATA.values():
        root.create_group(group)
        steps.create_group(f"{group}Offsets")
    for name, field in fields.items():
        if name != "position":
            _growing(root[DATA[field.on]], name, field)
            steps[f"{DATA[field.on]}Offsets"].create_dataset(name, (0,), int, maxshape=(None,))
    _growing(root["PointData"], INITIAL, fields["position"])
    _extend(root["PointData"][INITIAL], fields["position"].values - fields["displacement"].values)
    steps["PointDataOffsets"].create_dataset(INITIAL, (0,), int, maxshape=(None,))


def _append(root: Any, time: float, fields: Mapping[str, Field]) -> None:
    """Add a snapshot: first its data, then where it lies, at last that it is there."""
    steps = root["Steps"]
    before = root["Points"].shape[0]
    count = int(steps.attrs["NSteps"])
    for name, field in fields.items():
        data = root if name == "position" else root[DATA[field.on]]
        _extend(data["Points" if name == "position" else name], field.values)
    for group, size in (("PointData", before), ("CellData", count * int(root["NumberOfCells"][0]))):
        for name, dataset in steps[f"{group}Offsets"].items():
            _extend(dataset, [0 if name == INITIAL else size])
    for name, entry in (("Values", time), ("PartOffsets", 0), ("NumberOfParts", 1), ("PointOffsets", before)):
        _extend(steps[name], [entry])
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        _extend(steps[name], [[0]])
    steps.attrs["NSteps"] = count + 1


def _rewind(root: Any, count: int) -> None:
    """Forget all snapshots after the first ``count``."""
    steps = root["Steps"]
    sizes = {"PointData": count * int(root["NumberOfPoints"][0]), "CellData": count * int(root["NumberOfCells"][0])}
    root["Points"].resize(sizes["PointData"], axis=0)
    for group, size in sizes.items():
        for name, data in root[group].items():
            if name != INITIAL:
                data.resize(size, axis=0)
            steps[f"{group}Offsets"][name].resize(count, axis=0)
    for name in ("Values", "PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"):
        steps[name].resize(count, axis=0)
    steps.attrs["NSteps"] = count


def _whole(group: Any, name: str, values: NDArray[Any]) -> None:
    """Store an array that never changes."""
    group.create_dataset(name, data=values, **FILTERS)


def _growing(group: Any, name: str, field: Field) -> None:
    """Create an empty dataset for a field's rows, in equal parts: one that snapshots share is compressed for each."""
    count, rest = max(len(field.values), 1), field.values.shape[1:]
    rows = -(-count // -(-count // CHUNK))
    dataset = group.create_dataset(
        name, (0, *rest), field.values.dtype, maxshape=(None, *rest), chunks=(rows, *rest), **FILTERS
    )
    dataset.attrs["unit"] = np.bytes_(field.unit)  # text of its own length lies where no checksum is


def _extend(dataset: Any, rows: NDArray[Any] | list[Any]) -> None:
    start = dataset.shape[0]
    dataset.resize(start + len(rows), axis=0)
    dataset[start:] = rows


def _unit(dataset: Any) -> str:
    """Return the unit of a dataset; empty in files of format 5, whose text HDF5 may take forever to find if damaged."""
    if dataset.attrs.get_id("unit").get_type().is_variable_str():
        return ""
    return bytes(dataset.attrs["unit"]).decode("ascii")


@contextlib.contextmanager
def _changed(path: Path) -> Iterator[Any]:
    """Open the file to change it; h5py's types say of no name in it whether it is a group or a dataset."""
    with change(path) as overlay, h5py.File(overlay, "r+" if overlay.size else "w", libver=LAYOUT) as file:
        yield file


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[Any]:
    with reading(path) as raw, h5py.File(raw, "r") as file:
        yield file


def times(path: Path) -> NDArray[np.float64]:
    """Return the times of the snapshots in a file [ms]."""
    with _opened(path) as file:
        steps = file["VTKHDF/Steps"]
        return steps["Values"][: int(steps.attrs["NSteps"])]


def read(path: Path, number: int, only: Collection[str] | None = None) -> dict[str, Field]:
    """Return all fields of a snapshot, by its number, or ``only`` some, as far as they are there."""
    with _opened(path) as file:
        root = file["VTKHDF"]
        counts = {"points": int(root["NumberOfPoints"][0]), "cells": int(root["NumberOfCells"][0])}

        def rows(dataset: Any, offset: int, on: Any) -> Field:
            values = dataset[offset : offset + counts[on]]
            if len(values) < counts[on]:
                raise ValueError(f"{dataset.name} is cut off")
            return Field(values, _unit(dataset), on)

        def wanted(name: str) -> bool:
            return only is None or name in only

        fields = {}
        if wanted("position"):
            fields["position"] = rows(root["Points"], int(root["Steps/PointOffsets"][number]), "points")
        for on, group in DATA.items():
            offsets = root[f"Steps/{group}Offsets"]
            fields |= {
                name: rows(data, int(offsets[name][number]), on) for name, data in root[group].items() if wanted(name)
            }
        return fields
