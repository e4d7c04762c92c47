"""Runs that leave no file."""

import functools
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np

from viscopoint.errors import InputError
from viscopoint.model.callbacks import OnSnapshots
from viscopoint.model.energy_balance import UNITS
from viscopoint.model.method import Field
from viscopoint.model.simulation import Outcome, Simulation
from viscopoint.results.provenance import now, provenance, sources_of
from viscopoint.results.run import Run
from viscopoint.results.summary import Summary


class FieldsInMemory(OnSnapshots):
    """Keeps all fields at each snapshot."""

    def __init__(self) -> None:
        self.kept: list[tuple[float, dict[str, Field]]] = []

    def __call__(self, simulation: Simulation) -> None:
        fields = simulation.model.method.snapshot()
        copies = {name: field._replace(values=field.values.copy()) for name, field in fields.items()}
        self.kept.append((simulation.time, copies))

    def stopped(self, simulation: Simulation) -> None:
        if simulation.history.has_snapshot and (not self.kept or self.kept[-1][0] < simulation.time):
            self(simulation)


class RunInMemory(Run):
    """What a run left, as long as somebody holds it."""

    def __init__(self, simulation: Simulation, outcome: Outcome, fields: FieldsInMemory, threads: int) -> None:
        """Take over the results of a simulation that has ended, and was computed on so many threads."""
        model, start = simulation.model, simulation.balances[0].start.kinetic
        self.case, self.body, self.is_older = model.case, model.body, False
        self.results = Summary.of_start(model).ended(outcome, start, model.method.failure_hints)
        self.summary = self.results.model_dump(by_alias=True)
        self.rows = outcome.rows
        self.columns = dict(zip(UNITS, simulation.history.rows().T, strict=True))
        self.times = np.array([time for time, _ in fields.kept])
        self._kept, self._threads = [fields for _, fields in fields.kept], threads

    def __repr__(self) -> str:
        return f"Run(in memory, {self.status})"

    @property
    def place(self) -> str:
        return "the run in memory"

    @property
    def folder(self) -> Path:
        """There is none."""
        raise InputError("this run is in memory only; viscopoint.run(case, folder) leaves a run folder")

    @functools.cached_property
    def provenance(self) -> dict[str, Any]:
        """What made the run."""
        return provenance() | {"sources": sources_of(self.case), "threads": self._threads, "ended": now()}

    def _fields(self, number: int, only: Collection[str] | None) -> dict[str, Field]:
        kept = self._kept[number]
        wanted = kept.keys() if only is None else kept.keys() & only
        return {name: field._replace(values=field.values.copy()) for name, field in kept.items() if name in wanted}
