"""``fields.vtkhdf``: all fields at each snapshot, one file that ParaView and PyVista open as an animation.

Temporal VTKHDF 2.3 of type UnstructuredGrid, the points as vertices. The cells are stored once; positions and fields
are appended, and a snapshot counts (``NSteps``) only when all of it is there.
"""

import errno
import os
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from viscopoint.method import Field
from viscopoint.output import offer

NAME = "fields.vtkhdf"
INITIAL = "initial_position"  # stored once, for all snapshots
VERTEX = 1  # VTK's cell type
CHUNK = 16_384  # rows compressed together
RESERVE = 2**20  # bytes beside the raw size of a snapshot: HDF5's own, history and summary


@offer
class Fields:
    """Appends snapshots; the file is closed in between."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / NAME

    def row(self, row: Any) -> None:
        pass

    def snapshot(self, time: float, fields: Mapping[str, Field]) -> None:
        _ensure_space(self.path.parent, sum(field.values.nbytes for field in fields.values()))
        with _opened(self.path, "a") as file:
            if "VTKHDF" not in file:
                _begin(file, fields)
            _append(file["VTKHDF"], time, fields)

    def close(self) -> None:
        pass


def _ensure_space(folder: Path, size: int) -> None:
    """Raise ``OSError`` where a snapshot may not fit: HDF5 does not survive a disk that fills up under it."""
    if shutil.disk_usage(folder).free < size + RESERVE:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def _begin(file: Any, fields: Mapping[str, Field]) -> None:
    """Create the file's groups, the cells and what never changes."""
    root = file.create_group("VTKHDF")
    root.attrs["Version"] = np.array([2, 3])
    root.attrs.create("Type", np.bytes_("UnstructuredGrid"), dtype=h5py.string_dtype("ascii", 16))
    points = len(fields["position"].values)
    for name in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"):
        root[name] = np.array([points])
    root["Connectivity"] = np.arange(points)
    root["Offsets"] = np.arange(points + 1)
    root["Types"] = np.full(points, VERTEX, np.uint8)
    _growing(root, "Points", fields["position"])
    data = root.create_group("PointData")
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = 0
    for name, kind in (("Values", float), ("PartOffsets", int), ("NumberOfParts", int), ("PointOffsets", int)):
        steps.create_dataset(name, (0,), kind, maxshape=(None,))
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        steps.create_dataset(name, (0, 1), int, maxshape=(None, 1))
    offsets = steps.create_group("PointDataOffsets")
    for name, field in fields.items():
        if name != "position":
            _growing(data, name, field)
            offsets.create_dataset(name, (0,), int, maxshape=(None,))
    _growing(data, INITIAL, fields["position"])
    _extend(data[INITIAL], fields["position"].values - fields["displacement"].values)
    offsets.create_dataset(INITIAL, (0,), int, maxshape=(None,))


def _append(root: Any, time: float, fields: Mapping[str, Field]) -> None:
    """Add a snapshot: first its data, then where it lies, at last that it is there."""
    steps, data = root["Steps"], root["PointData"]
    before = root["Points"].shape[0]
    count = int(steps.attrs["NSteps"])
    for name, field in fields.items():
        _extend(root["Points"] if name == "position" else data[name], field.values)
    for name, dataset in steps["PointDataOffsets"].items():
        _extend(dataset, [0 if name == INITIAL else before])
    for name, entry in (("Values", time), ("PartOffsets", 0), ("NumberOfParts", 1), ("PointOffsets", before)):
        _extend(steps[name], [entry])
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        _extend(steps[name], [[0]])
    steps.attrs["NSteps"] = count + 1


def _growing(group: Any, name: str, field: Field) -> None:
    """Create an empty dataset for a field's rows."""
    rest = field.values.shape[1:]
    dataset = group.create_dataset(
        name, (0, *rest), field.values.dtype,
        maxshape=(None, *rest), chunks=(CHUNK, *rest), compression="gzip", compression_opts=1, shuffle=True,
    )  # fmt: skip
    dataset.attrs["unit"] = field.unit


def _extend(dataset: Any, rows: NDArray[Any] | list[Any]) -> None:
    start = dataset.shape[0]
    dataset.resize(start + len(rows), axis=0)
    dataset[start:] = rows


def _opened(path: Path, mode: Any) -> Any:
    """Open the file; h5py's types say of no name in it whether it is a group or a dataset."""
    return h5py.File(path, mode)


def times(path: Path) -> NDArray[np.float64]:
    """Return the times of the snapshots in a file [ms]."""
    with _opened(path, "r") as file:
        steps = file["VTKHDF/Steps"]
        return steps["Values"][: int(steps.attrs["NSteps"])]


def read(path: Path, number: int) -> dict[str, Field]:
    """Return all fields of a snapshot, by its number."""
    with _opened(path, "r") as file:
        root = file["VTKHDF"]
        points = int(root["NumberOfPoints"][0])

        def rows(dataset: Any, offset: int) -> Field:
            return Field(dataset[offset : offset + points], str(dataset.attrs["unit"]))

        offsets = root["Steps/PointDataOffsets"]
        fields = {"position": rows(root["Points"], int(root["Steps/PointOffsets"][number]))}
        return fields | {name: rows(data, int(offsets[name][number])) for name, data in root["PointData"].items()}
