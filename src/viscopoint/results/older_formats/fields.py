"""``fields.vtkhdf``: all snapshots in one temporal VTKHDF file."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from h5py import h5t
from numpy.typing import NDArray

from viscopoint.case.schedules import MOST_TIMES
from viscopoint.model.method import Field
from viscopoint.results.hdf5 import opened, rows
from viscopoint.results.vtkhdf import COUNTS, DATA, ensure_memory, row_size, unit_of

NAME, JOURNAL = "fields.vtkhdf", ".fields.vtkhdf.journal"
INITIAL = "initial_position"  # stored once, for all snapshots; now it is no field


def times(path: Path) -> NDArray[np.float64]:
    """Return the times of the snapshots in a file [ms]."""
    _check_whole(path)
    with opened(path) as file:
        steps = file["VTKHDF/Steps"]
        found = rows(steps["Values"], 0, _count(steps))
    if found.shape != (len(found),) or not np.isfinite(found).all():
        raise ValueError("the times of its snapshots are none")
    return found.astype(float)


def read(path: Path, number: int, only: Collection[str] | None = None) -> dict[str, Field]:
    """Return all fields of a snapshot, by its number, or ``only`` some, as far as they are there."""
    _check_whole(path)
    with opened(path) as file:
        root = file["VTKHDF"]
        counts = {on: int(root[name][0]) for on, name in COUNTS.items()}
        places = {"position": (root["Points"], int(root["Steps/PointOffsets"][number]), "points")}
        for on, group in DATA.items():
            offsets = root[f"Steps/{group}Offsets"]
            places |= {name: (data, int(offsets[name][number]), on) for name, data in root[group].items()}
        wanted = places.keys() - {INITIAL} if only is None else places.keys() & only
        chosen = {name: place for name, place in places.items() if name in wanted}
        ensure_memory(min(len(data), counts[on]) * row_size(data) for data, _, on in chosen.values())
        return {name: _field(data, offset, counts[on], on) for name, (data, offset, on) in chosen.items()}


def _check_whole(path: Path) -> None:
    """Raise ``ValueError`` if a process was killed while it changed the file, which the version that began can mend."""
    if path.with_name(JOURNAL).exists():
        raise ValueError("a snapshot was being written as its process was killed; resume it by the version that began")


def _field(dataset: Any, offset: int, count: int, on: Any) -> Field:
    values = rows(dataset, offset, offset + count)
    if len(values) < count:
        raise ValueError(f"{dataset.name} is cut off")
    return Field(values, unit_of(dataset), on)


def _count(steps: Any) -> int:
    """Return how many snapshots there are."""
    if steps.attrs.get_id("NSteps").get_type().get_class() != h5t.INTEGER:
        raise ValueError("the number of snapshots is none")
    count = int(steps.attrs["NSteps"])
    if not 0 <= count <= MOST_TIMES + 2:  # and the start, and the end
        raise ValueError(f"{count} snapshots are more than a run can have")
    return count
