"""``history.csv``: one line per row of the ledger, units in the header."""

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from viscopoint.body import Body
from viscopoint.folder import sync
from viscopoint.ledger import UNITS, Row
from viscopoint.method import Field
from viscopoint.output import Mark, offer

NAME = "history.csv"
HEADINGS = [f"{name} [{unit}]" for name, unit in UNITS.items()]


@offer
class History:
    """Writes lines as they come, so that an interrupted run keeps them."""

    def __init__(self, folder: Path, body: Body, mark: Mark | None) -> None:
        path, self.place = folder / NAME, mark.place if mark else 0
        if mark and not _ends_line(path, mark.place):
            raise ValueError(f"{NAME} is cut off")
        self.file = path.open("a", newline="", encoding="utf-8")
        self.table = csv.writer(self.file)

    def begin(self) -> None:
        self.file.truncate(self.place)
        if self.place == 0:
            self.table.writerow(HEADINGS)

    def row(self, row: Row) -> None:
        self.table.writerow(row)

    def snapshot(self, time: float, fields: Mapping[str, Field]) -> None:
        self.file.flush()

    def mark(self) -> int:
        sync(self.file)
        return self.file.tell()

    def close(self) -> None:
        self.file.close()


def _ends_line(path: Path, place: int) -> bool:
    """Return whether a file is there, and a line after the headings ends at a place in it."""
    if not path.exists() or not len(",".join(HEADINGS)) < place <= path.stat().st_size:
        return False
    with path.open("rb") as file:
        file.seek(place - 1)
        return file.read(1) == b"\n"


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
