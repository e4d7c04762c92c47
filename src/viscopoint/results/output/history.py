"""``history.csv``: one line per row of the history, units in the header."""

import csv
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from viscopoint.model.build import Model
from viscopoint.model.callbacks import OnRows
from viscopoint.model.energy_balance import UNITS
from viscopoint.model.simulation import Simulation
from viscopoint.results.folder import whole
from viscopoint.results.output import OUTPUTS

NAME = "history.csv"
HEADINGS = [f"{name} [{unit}]" for name, unit in UNITS.items()]


@OUTPUTS.register("history")
class History(OnRows):
    """Writes lines as they come, so that an interrupted run keeps them."""

    def __init__(self, folder: Path, model: Model) -> None:
        self.path, self.written = folder / NAME, 0
        self.file: IO[str] | None = None

    def begin(self, simulation: Simulation) -> None:
        with whole(self.path) as part, part.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerow(HEADINGS)
            self._write(file, simulation)
        self.file = self.path.open("a", newline="", encoding="utf-8")

    def __call__(self, simulation: Simulation) -> None:
        if self.file:
            self._write(self.file, simulation)
            if simulation.at_snapshot:
                self.file.flush()

    def stopped(self, simulation: Simulation) -> None:
        self(simulation)

    def _write(self, file: IO[str], simulation: Simulation) -> None:
        """Write the rows that are not in the file yet."""
        rows = range(self.written, len(simulation.history))
        csv.writer(file).writerows(map(simulation.history.row, rows))
        self.written = rows.stop

    def close(self) -> None:
        if self.file:
            self.file.close()


def read(path: Path) -> dict[str, NDArray[np.float64]]:
    """Return the columns of a file by name, without a last line that a killed process did not finish.

    Raises:
        ValueError: it is none of ours, or damaged.
    """
    with path.open(newline="", encoding="utf-8") as file:
        names = [heading.partition(" [")[0] for heading in next(csv.reader(file), [])]
        lines = file.readlines()
    lines = lines if lines and lines[-1].endswith("\n") else lines[:-1]
    if not lines:
        raise ValueError("no rows")
    rows = np.loadtxt(lines, delimiter=",", ndmin=2)
    if rows.shape[1] != len(names):
        raise ValueError(f"{len(names)} headings over {rows.shape[1]} columns")
    return dict(zip(names, rows.T, strict=True))
