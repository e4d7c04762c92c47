"""``fields.vtkhdf``: all fields at each snapshot, one file that ParaView and PyVista open as an animation.

Temporal VTKHDF 2.3 of type UnstructuredGrid: finite elements as hexahedra, or quadrilaterals of an axisymmetric body's
half section; material points as vertices. The cells are stored once; positions and fields are appended, each snapshot
as a whole or not at all (``transaction``), with a checksum of every piece, so that damage is found and not shown.
"""

import errno
import math
import os
import shutil
import zlib
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from h5py import h5t
from numpy.typing import NDArray

from viscopoint.case.tables import MOST_SNAPSHOTS
from viscopoint.kernels.arrays import Indices
from viscopoint.model import memory
from viscopoint.model.body import Body
from viscopoint.model.method import Field
from viscopoint.results.hdf5 import FILTERS, changed, check_pieces, opened, rows
from viscopoint.results.output import WRITERS, Mark

NAME = "fields.vtkhdf"
INITIAL = "initial_position"  # stored once, for all snapshots
KINDS = {1: 1, 4: 9, 8: 12}  # VTK's cell types by the number of corners: vertex, quadrilateral, hexahedron
DATA = {"points": "PointData", "cells": "CellData"}
ONCE = ("Connectivity", "Offsets", "Types")  # datasets that do not change
CHUNK = 16_384  # greatest number of rows compressed together
RESERVE = 2**20  # bytes beside the raw size of a snapshot: HDF5's own, history and summary


@WRITERS.register("fields")
class Fields:
    """Appends snapshots; the file is closed in between."""

    def __init__(self, folder: Path, body: Body, mark: Mark | None) -> None:
        self.path, self.cells = folder / NAME, body.cells
        self.count, self.check = (mark.place, mark.check) if mark else (0, 0)
        if mark:
            _check_mark(self.path, mark)

    def begin(self) -> None:
        if self.count == 0:
            self.path.unlink(missing_ok=True)
        else:
            with changed(self.path) as file:
                _rewind(file["VTKHDF"], self.count)

    def row(self, row: Any) -> None:
        pass

    def snapshot(self, time: float, fields: Mapping[str, Field]) -> None:
        _ensure_space(self.path.parent, sum(field.values.nbytes for field in fields.values()))
        with changed(self.path) as file:
            if "VTKHDF" not in file:
                _begin(file, fields, self.cells)
            _append(file["VTKHDF"], time, fields)
        self.count, self.check = self.count + 1, _sum(time, fields, self.check)

    def mark(self) -> tuple[int, int]:
        return self.count, self.check

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
    count = _count(steps)
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


def _check_mark(path: Path, mark: Mark) -> None:
    """Raise ``ValueError`` unless the file has all snapshots that a mark speaks of, as they were written."""
    if mark.place != mark.snapshots or not path.exists():
        raise ValueError(f"{NAME} has not the snapshots of the run")
    with opened(path) as file:
        root = file["VTKHDF"]
        for dataset, length in _lengths_at(root, mark.place):
            if len(dataset) < length or _count(root["Steps"]) < mark.place:
                raise ValueError(f"{NAME} has not the {mark.place} snapshots of the checkpoint")
            check_pieces(dataset, length - 1, length)  # to which the next rows are added
        for name in ONCE:
            rows(root[name], 0, len(root[name]))
        if _sum_of(root, mark.place) != mark.check:
            raise ValueError(f"{NAME} does not hold what was written")


def check_of(path: Path, count: int) -> int:
    """Return the CRC-32 of the first snapshots in a file, by which a mark knows them."""
    with opened(path) as file:
        return _sum_of(file["VTKHDF"], count)


def _sum_of(root: Any, count: int) -> int:
    check = 0
    for number in range(count):
        time = rows(root["Steps/Values"], number, number + 1)
        check = _sum(float(time[0]), _snapshot(root, number), check)
    return check


def _sum(time: float, fields: Mapping[str, Field], check: int) -> int:
    """Return the CRC-32 of what comes before a snapshot and of the snapshot."""
    check = zlib.crc32(np.float64(time).tobytes(), check)
    for name in sorted(fields.keys() - {INITIAL}):
        check = zlib.crc32(np.ascontiguousarray(fields[name].values).data, check)
    return check


def _rewind(root: Any, count: int) -> None:
    """Forget all snapshots after the first ``count``."""
    for dataset, length in _lengths_at(root, count):
        dataset.resize(length, axis=0)
    root["Steps"].attrs["NSteps"] = count


def _lengths_at(root: Any, count: int) -> Iterator[tuple[Any, int]]:
    """Yield each dataset that snapshots lengthen, and how many rows it has after ``count`` of them."""
    steps = root["Steps"]
    points, cells = (count * int(root[name][0]) for name in ("NumberOfPoints", "NumberOfCells"))
    yield root["Points"], points
    for group, length in (("PointData", points), ("CellData", cells)):
        for name, dataset in root[group].items():
            if name != INITIAL:
                yield dataset, length
            yield steps[f"{group}Offsets"][name], count
    for name in ("Values", "PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"):
        yield steps[name], count


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
    dataset.attrs["unit"] = np.bytes_(field.unit)  # of fixed length: other text lies where HDF5 has no checksums


def _extend(dataset: Any, rows: NDArray[Any] | list[Any]) -> None:
    start = dataset.shape[0]
    dataset.resize(start + len(rows), axis=0)
    dataset[start:] = rows


def _unit(dataset: Any) -> str:
    """Return the unit of a dataset; empty in files of format 5, where HDF5 may seek it forever if it is damaged."""
    if dataset.attrs.get_id("unit").get_type().is_variable_str():
        return ""
    return bytes(dataset.attrs["unit"]).decode("ascii")


def _count(steps: Any) -> int:
    """Return how many snapshots there are."""
    if steps.attrs.get_id("NSteps").get_type().get_class() != h5t.INTEGER:
        raise ValueError("the number of snapshots is none")
    count = int(steps.attrs["NSteps"])
    if not 0 <= count <= MOST_SNAPSHOTS + 2:  # and the start, and the end
        raise ValueError(f"{count} snapshots are more than a run can have")
    return count


def times(path: Path) -> NDArray[np.float64]:
    """Return the times of the snapshots in a file [ms]."""
    with opened(path) as file:
        steps = file["VTKHDF/Steps"]
        found = rows(steps["Values"], 0, _count(steps))
    if found.shape != (len(found),) or not np.isfinite(found).all():
        raise ValueError("the times of its snapshots are none")
    return found.astype(float)


def read(path: Path, number: int, only: Collection[str] | None = None) -> dict[str, Field]:
    """Return all fields of a snapshot, by its number, or ``only`` some, as far as they are there."""
    with opened(path) as file:
        return _snapshot(file["VTKHDF"], number, only)


def _snapshot(root: Any, number: int, only: Collection[str] | None = None) -> dict[str, Field]:
    counts = {"points": int(root["NumberOfPoints"][0]), "cells": int(root["NumberOfCells"][0])}
    places = {"position": (root["Points"], int(root["Steps/PointOffsets"][number]), "points")}
    for on, group in DATA.items():
        offsets = root[f"Steps/{group}Offsets"]
        places |= {name: (dataset, int(offsets[name][number]), on) for name, dataset in root[group].items()}
    if only is not None:
        places = {name: place for name, place in places.items() if name in only}
    _ensure_memory(min(len(dataset), counts[on]) * _row(dataset) for dataset, _, on in places.values())
    return {name: _rows(dataset, offset, counts[on], on) for name, (dataset, offset, on) in places.items()}


def _rows(dataset: Any, offset: int, count: int, on: Any) -> Field:
    values = rows(dataset, offset, offset + count)
    if len(values) < count:
        raise ValueError(f"{dataset.name} is cut off")
    return Field(values, _unit(dataset), on)


def _row(dataset: Any) -> int:
    """Return what a row of a dataset takes [bytes]."""
    return math.prod(dataset.shape[1:]) * dataset.dtype.itemsize


def _ensure_memory(sizes: Iterable[int]) -> None:
    """Raise ``ValueError`` where fields of these sizes [bytes] would not fit."""
    size, there = sum(sizes), memory.free()
    if size > there:
        raise ValueError(f"the snapshot takes {size / 2**30:.3g} GiB, there are {there / 2**30:.3g}")
