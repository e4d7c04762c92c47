"""``history.csv``: one line per history row, units in the header."""

import csv
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from viscopoint.model.body import Body
from viscopoint.model.energy_balance import UNITS, Row
from viscopoint.model.method import Field
from viscopoint.results.folder import sync
from viscopoint.results.output import WRITERS, Mark

NAME = "history.csv"
BLOCK = 2**20  # bytes read at once
HEADINGS = [f"{name} [{unit}]" for name, unit in UNITS.items()]


@WRITERS.register("history")
class History:
    """Writes lines as they come, so that an interrupted run keeps them."""

    def __init__(self, folder: Path, body: Body, mark: Mark | None) -> None:
        self.path, self.place, self.check = folder / NAME, mark.place if mark else 0, mark.check if mark else 0
        if mark and not _ends_line(self.path, mark.place):
            raise ValueError(f"{NAME} is cut off")
        if mark and _sum(self.path, 0, mark.place) != mark.check:
            raise ValueError(f"{NAME} is not what was written")
        self.file = self.path.open("a", newline="", encoding="utf-8")
        self.table = csv.writer(self.file)

    def begin(self) -> None:
        self.file.truncate(self.place)
        if self.place == 0:
            self.table.writerow(HEADINGS)

    def row(self, row: Row) -> None:
        self.table.writerow(row)

    def snapshot(self, time: float, fields: Mapping[str, Field]) -> None:
        self.file.flush()

    def mark(self) -> tuple[int, int]:
        sync(self.file)
        start, self.place = self.place, self.file.tell()
        self.check = _sum(self.path, start, self.place, self.check)
        return self.place, self.check

    def close(self) -> None:
        self.file.close()


def _ends_line(path: Path, place: int) -> bool:
    """Return whether a file is there, and a line after the headings ends at a place in it."""
    if not path.exists() or not len(",".join(HEADINGS)) < place <= path.stat().st_size:
        return False
    with path.open("rb") as file:
        file.seek(place - 1)
        return file.read(1) == b"\n"


def _sum(path: Path, start: int, end: int, check: int = 0) -> int:
    """Return the CRC-32 of a part of a file, or of what comes before and that part."""
    with path.open("rb") as file:
        file.seek(start)
        while block := file.read(min(end - file.tell(), BLOCK)):
            check = zlib.crc32(block, check)
    return check


def read(path: Path) -> dict[str, NDArray[np.float64]]:
    """Return the columns of a file by name; raise ``ValueError`` if it is none of ours, or damaged."""
    with path.open(newline="", encoding="utf-8") as file:
        names = [heading.partition(" [")[0] for heading in next(csv.reader(file), [])]
        lines = file.readlines()
    if not lines:
        raise ValueError("no rows")
    rows = np.loadtxt(lines, delimiter=",", ndmin=2)
    if rows.shape[1] != len(names):
        raise ValueError(f"{len(names)} headings over {rows.shape[1]} columns")
    return dict(zip(names, rows.T, strict=True))
