"""``fields/``: a file for each snapshot, and the index that ParaView and PyVista open as an animation."""

import errno
import math
import os
import shutil
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from viscopoint.kernels.arrays import AnyArray
from viscopoint.model.build import Model
from viscopoint.model.callbacks import OnSnapshots
from viscopoint.model.simulation import Simulation
from viscopoint.results import vtkhdf
from viscopoint.results.folder import whole, write_json
from viscopoint.results.output import OUTPUTS
from viscopoint.results.safe_read import contents, kept, table

INDEX, FOLDER, NAMES = "fields.vtkhdf.series", "fields", "fields_{:05d}.vtkhdf"
LARGEST_INDEX = 16_000_000  # bytes
BLOCK = 2**20  # bytes read at once
RESERVE = 2**20  # bytes beside the raw size of a snapshot: HDF5's own, history and summary


@OUTPUTS.register("fields")
class Fields(OnSnapshots):
    """Writes a file for each snapshot, whole or not at all."""

    name = "fields"

    def __init__(self, folder: Path, model: Model) -> None:
        self.folder, self.cells = folder, model.body.cells
        self.times: list[float] = []  # of the snapshots, ms
        self.checks: list[int] = []  # CRC-32 of their files

    def begin(self, simulation: Simulation) -> None:
        (self.folder / FOLDER).mkdir(exist_ok=True)
        for file in files_after(self.folder, len(self.times)):
            file.unlink()
        self._write_index()

    def __call__(self, simulation: Simulation) -> None:
        fields = simulation.model.method.snapshot()
        _ensure_space(self.folder, sum(field.values.nbytes for field in fields.values()))
        path = file_of(self.folder, len(self.times))
        with whole(path) as part:
            vtkhdf.write(part, simulation.time, fields, self.cells)
        self.checks.append(_crc(path))
        self.times.append(simulation.time)
        self._write_index()

    def stopped(self, simulation: Simulation) -> None:
        if simulation.history.has_snapshot and self.times[-1:] != [simulation.time]:
            self(simulation)

    def _write_index(self) -> None:
        files = [{"name": f"{FOLDER}/{NAMES.format(n)}", "time": time} for n, time in enumerate(self.times)]
        write_json(self.folder / INDEX, {"file-series-version": "1.0", "files": files})

    def state(self) -> Mapping[str, AnyArray]:
        return {"times": np.array(self.times, float), "checks": np.array(self.checks, np.int64)}

    def restore(self, state: Mapping[str, AnyArray], simulation: Simulation) -> None:
        self.times, self.checks = state["times"].tolist(), state["checks"].tolist()
        if self.times != [row.time for row in simulation.history.of_snapshots()]:
            raise ValueError("its snapshots are not those of its history")
        for number, check in enumerate(self.checks):
            path = file_of(self.folder, number)
            if not path.is_file() or _crc(path) != check:
                raise ValueError(f"{FOLDER}/{path.name} is not what was written")


def file_of(folder: Path, number: int) -> Path:
    """Return the file of a snapshot in a run folder."""
    return folder / FOLDER / NAMES.format(number)


def files_after(folder: Path, count: int) -> list[Path]:
    """Return the files of snapshots in a run folder but for the first ones; there may be other files beside them."""
    found = sorted((folder / FOLDER).glob(NAMES.replace("{:05d}", "*")))
    return [file for file in found if file not in {file_of(folder, number) for number in range(count)}]


def _crc(path: Path) -> int:
    """Return the CRC-32 of a file."""
    check = 0
    with path.open("rb") as file:
        while block := file.read(BLOCK):
            check = zlib.crc32(block, check)
    return check


def _ensure_space(folder: Path, size: int) -> None:
    """Raise ``OSError`` where a snapshot may not fit, before it is compressed."""
    if shutil.disk_usage(folder).free < size + RESERVE:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def times(folder: Path) -> NDArray[np.float64]:
    """Return the times of the snapshots in a run folder [ms].

    Raises:
        OSError, ValueError: the index is not there, or none of ours.
    """
    listed = table(contents(kept(folder, INDEX, LARGEST_INDEX), LARGEST_INDEX)).get("files")
    if not isinstance(listed, list):
        raise ValueError("it lists no files")
    found = [entry.get("time") if isinstance(entry, dict) else None for entry in listed]
    if not all(isinstance(time, float) and math.isfinite(time) for time in found):
        raise ValueError("the times of its snapshots are none")
    if any(entry.get("name") != f"{FOLDER}/{NAMES.format(number)}" for number, entry in enumerate(listed)):
        raise ValueError("it lists other files")
    return np.array(found, float)
