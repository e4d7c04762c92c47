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
from viscopoint.output import offer

NAME = "history.csv"


@offer
class History:
    """Writes lines as they come, so that an interrupted run keeps them."""

    def __init__(self, folder: Path, body: Body, mark: int | None) -> None:
        path = folder / NAME
        if mark is not None and path.stat().st_size < mark:
            raise ValueError(f"{NAME} is cut off")
        self.file = path.open("w" if mark is None else "r+", newline="", encoding="utf-8")
        self.table = csv.writer(self.file)
        if mark is None:
            self.table.writerow(f"{name} [{unit}]" for name, unit in UNITS.items())
        else:
            self.file.truncate(mark)
            self.file.seek(mark)

    def row(self, row: Row) -> None:
        self.table.writerow(row)

    def snapshot(self, time: float, fields: Mapping[str, Field]) -> None:
        self.file.flush()

    def mark(self) -> int:
        sync(self.file)
        return self.file.tell()

    def close(self) -> None:
        self.file.close()


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
