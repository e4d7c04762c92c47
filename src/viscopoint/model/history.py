"""The history of a run: a row of measurements of each body, as often as the case asks."""

from array import array
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from viscopoint.kernels.arrays import AnyArray, Array
from viscopoint.model.callbacks import Callback
from viscopoint.model.energy_balance import EnergyBalance, Row, row_of
from viscopoint.model.guards import is_finite
from viscopoint.model.schedule import Schedule

if TYPE_CHECKING:
    from viscopoint.model.simulation import Simulation

WIDTH = len(Row._fields)
TIME, STEP = Row._fields.index("time"), Row._fields.index("step")


class History(Callback):
    """Measures all bodies when a row or a snapshot is due, and keeps all rows."""

    name = "history"

    def __init__(self, schedule: Schedule, balances: Sequence[EnergyBalance]) -> None:
        self.schedule, self.balances = schedule, balances
        self._rows = [array("d") for _ in balances]
        self._of_snapshots: list[int] = []  # numbers of the rows

    def due(self, simulation: "Simulation") -> bool:
        return simulation.at_snapshot or super().due(simulation)

    def __call__(self, simulation: "Simulation") -> None:
        for balance in self.balances:
            balance.record(simulation.time, simulation.step, simulation.time_step)
        self._keep(simulation.at_snapshot)

    def stopped(self, simulation: "Simulation") -> None:
        if self.newest.time < simulation.time:  # no row was due at this step
            for balance in self.balances:
                balance.row(simulation.time, simulation.step, simulation.time_step)
            self._keep(of_snapshot=False)
        last = len(self) - 1
        self._of_snapshots = [number for number in self._of_snapshots if number != last]
        if is_finite(self.newest):
            self._of_snapshots.append(last)

    def _keep(self, of_snapshot: bool) -> None:
        if of_snapshot:
            self._of_snapshots.append(len(self))
        for rows, balance in zip(self._rows, self.balances, strict=True):
            rows.extend(balance.before)

    def __len__(self) -> int:
        return len(self._rows[0]) // WIDTH

    @property
    def newest(self) -> Row:
        """The newest row of the first body."""
        return self.balances[0].before

    @property
    def has_snapshot(self) -> bool:
        """Whether the newest row is that of a snapshot."""
        return bool(self._of_snapshots) and self._of_snapshots[-1] == len(self) - 1

    def row(self, number: int, body: int = 0) -> Row:
        """Return one row of a body."""
        return row_of(self._rows[body][number * WIDTH : (number + 1) * WIDTH])

    def rows(self, body: int = 0) -> Array:
        """Return all rows of a body, ``[row, column]`` in the order of ``Row``."""
        return np.array(self._rows[body]).reshape(-1, WIDTH)

    def of_snapshots(self, body: int = 0) -> list[Row]:
        """Return the rows of a body at the snapshots."""
        return [self.row(number, body) for number in self._of_snapshots]

    def state(self) -> Mapping[str, AnyArray]:
        return {
            "rows": np.stack([self.rows(body) for body in range(len(self.balances))]),
            "of_snapshots": np.array(self._of_snapshots, np.int64),
            "accounts": np.array([balance.account() for balance in self.balances]),
        }

    def restore(self, state: Mapping[str, AnyArray], simulation: "Simulation") -> None:
        rows, numbers = state["rows"], state["of_snapshots"]
        if rows.shape != (len(self.balances), len(rows[0]), WIDTH) or not len(rows[0]):
            raise ValueError("its history is none")
        whole = all(is_finite(row_of(row)) for body in rows for row in body)
        times = rows[0, :, TIME]
        if not whole or times[0] != 0.0 or (np.diff(times) <= 0.0).any() or times[-1] > simulation.time:
            raise ValueError("its history is none of a run to where it stands")
        if (np.diff(numbers, prepend=-1) <= 0).any():
            raise ValueError("its snapshots are in no order")
        if not set(simulation.snapshots_until(simulation.time)) <= set(times[numbers].tolist()):
            raise ValueError("its snapshots are not those of the case")
        for balance, account, measured in zip(self.balances, state["accounts"], rows, strict=True):
            balance.restore(account.tolist(), row_of(measured[-1]))
        self._rows = [array("d", measured.ravel()) for measured in rows]
        self._of_snapshots = numbers.tolist()
