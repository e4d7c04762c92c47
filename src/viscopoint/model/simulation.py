"""Drives bodies through time: exact snapshot times, energy balances, guards, outputs."""

import math
import time as clock
from collections.abc import Callable, Sequence
from typing import Literal, NamedTuple

import numpy as np

from viscopoint.errors import InputError
from viscopoint.integrators.central_differences import CentralDifferences
from viscopoint.kernels.jit import check_ready
from viscopoint.model.build import Model
from viscopoint.model.energy_balance import EnergyBalance, ReferenceEnergy, Row, row_of
from viscopoint.model.guards import GuardError, check_row, check_step, is_finite, lost_in_words
from viscopoint.results.checkpoint import Checkpoint, Keeper
from viscopoint.results.interruption import Stop
from viscopoint.results.output import Writer

Watch = Callable[[float, Row], None]
LOSSES = "complete with losses"  # the status of a run that came to its end without some of its points or elements
SAME_TIME = 1e-9  # relative: two instants of a case that differ by less are one


class Outcome(NamedTuple):
    """How a run ended."""

    status: Literal["complete", "complete with losses", "stopped", "interrupted"]
    reason: str  # why, if it is not complete
    signal: str  # that interrupted it, such as "SIGINT"
    rows: list[Row]  # at the snapshots
    steps: int
    wall_time: float  # s, of the steps and the measurements, less the first step, which may compile
    energy_error: float  # greatest share of the reference energy that was ever missing
    momentum_error: float  # greatest difference ever of momentum gained and impulse received, N ms
    hourglass_share: float  # greatest ever, %


class Simulation:
    """The bodies of a model on their way from the start of its case, or from a checkpoint, to the end.

    One step serves all, the shortest that any of them needs. Each has an energy balance of its own; what is written is
    the first body's, the rod's.
    """

    def __init__(
        self,
        model: Model,
        writers: Sequence[Writer] = (),
        watch: Watch | None = None,
        keeper: Keeper | None = None,
        stop: Stop | None = None,
    ) -> None:
        """Prepare to run a model; ``keeper`` writes checkpoints, ``stop`` says when somebody wants to end it.

        Raises:
            InputError: a keeper for several bodies, of which a checkpoint does not tell.
        """
        if keeper and len(model.bodies) > 1:
            raise InputError(f"checkpoints: written of one body only; this model has {len(model.bodies)}")
        check_ready()  # the model may have been built before a fork
        self.model, self.writers, self.watch = model, writers, watch
        self.keeper, self.stop = keeper, stop or Stop()
        self.integrator = CentralDifferences(model.bodies)
        reference = ReferenceEnergy(model.bodies)
        self.balances = tuple(EnergyBalance(body, reference) for body in model.bodies)
        self.balance = self.balances[0]
        self.time, self.step, self.time_step, self.busy = 0.0, 0, 0.0, 0.0
        self.first_steps = [body.stable_step() for body in model.bodies]

    @np.errstate(all="ignore")  # guards tell what is not finite, once
    def run(self) -> Outcome:
        """Run to the end of the case; a guard or an interruption ends it earlier, and all up to then is kept."""
        status, reason = "complete", ""
        try:
            self._go()
        except GuardError as error:
            status, reason = "stopped", str(error)
            self._keep_last_state()
        except KeyboardInterrupt:
            status, reason = "interrupted", f"interrupted after t = {self.time * 1e3:.4g} us"
        lossy = [balance for balance in self.balances if balance.before.lost]
        if status == "complete" and lossy:
            told = [lost_in_words(balance.before, balance.start.mass, balance.method) for balance in lossy]
            status, reason = LOSSES, "; ".join(told)
        signal = self.stop.asked if status == "interrupted" else ""  # one that came in the last step changes nothing
        return Outcome(status, reason, signal, self.balance.rows, self.step, self.busy, *self.balance.errors)

    def _go(self) -> None:
        if not self.balance.rows:
            self._snapshot(self._record(0.0))
        self._check_steps()
        for instant in self._instants()[len(self.balance.rows) - 1 :]:
            self._snapshot(self._advance_to(instant))

    def resume(self, checkpoint: Checkpoint) -> None:
        """Go on from a checkpoint of the same model by the same version; raise ``ValueError`` if it is none."""
        progress, balance = checkpoint.progress, self.balance
        rows = [row_of(values) for values in progress.rows]
        instants, newest = [0.0, *self._instants()], row_of(progress.before)
        ordered = rows[-1].time <= newest.time <= progress.time <= instants[-1]
        if not all(map(is_finite, (*rows, newest))):
            raise ValueError("its numbers are not finite")
        if [row.time for row in rows] != instants[: len(rows)] or not ordered:
            raise ValueError("its times are not those of the case")
        if not np.allclose(progress.start, balance.start.flat(), rtol=1e-9):
            raise ValueError("it does not begin as the case does")
        self.model.method.restore(checkpoint.state)
        balance.restore(progress.start, progress.before, progress.internal)
        self.time, self.step, self.time_step = progress.time, progress.step, progress.time_step
        self.busy, balance.errors, balance.rows = progress.busy, progress.errors, rows

    def _checkpoint(self) -> None:
        if self.keeper is None:
            return
        balance = self.balance
        self.keeper.write(
            self.model.method.state(),
            time=self.time, step=self.step, time_step=self.time_step, busy=self.busy, errors=balance.errors,
            start=balance.start.flat(), before=list(balance.before), internal=balance.internal,
            rows=[list(row) for row in balance.rows],
            marks=[writer.mark() for writer in self.writers],
        )  # fmt: skip

    def _instants(self) -> list[float]:
        """Return the times of all snapshots after the start."""
        time = self.model.case.time
        instants: list[float] = []
        for instant in sorted((*time.snapshots, time.end)):
            if not instants or instant > instants[-1] * (1 + SAME_TIME):
                instants.append(instant)
        return instants

    def stable_step(self) -> float:
        """Return the longest step that all bodies can take next [ms]."""
        return min(body.stable_step() for body in self.model.bodies)

    def _advance_to(self, instant: float) -> list[Row]:
        """Step to an instant exactly, in steps of equal length as far as the stable step allows."""
        rows = [balance.before for balance in self.balances]
        between = self.model.case.output.history_interval or 0.0
        while self.time < instant:
            began = clock.perf_counter()
            left = math.ceil((instant - self.time) / self.stable_step() * (1 - SAME_TIME))
            dt = (instant - self.time) / max(left, 1)
            self.integrator.advance(dt)
            self.time = instant if left <= 1 else self.time + dt
            self.step, self.time_step = self.step + 1, dt
            if left <= 1 or self.time - rows[0].time >= between:
                rows = self._record(dt)
            self._check_steps()
            self.busy += clock.perf_counter() - began if self.step > 1 else 0.0
            if self.stop.asked or (self.keeper and self.keeper.due(self.time)):
                self._checkpoint()
            if self.stop.asked:
                raise KeyboardInterrupt
        return rows

    def _check_steps(self) -> None:
        for body, first in zip(self.model.bodies, self.first_steps, strict=True):
            check_step(self.time, first, self.model.case.guards, body)

    def _record(self, dt: float) -> list[Row]:
        """Measure, hand the row to all who want it, and let the guards look at it."""
        rows = [balance.record(self.time, self.step, dt) for balance in self.balances]
        for writer in self.writers:
            writer.row(rows[0])
        if self.watch:
            self.watch(self.time / self.model.case.time.end, rows[0])
        for balance, row in zip(self.balances, rows, strict=True):
            check_row(row, balance.start, balance.reference, self.model.case.guards, balance.method)
        return rows

    def _keep_last_state(self) -> None:
        """Keep what a guard stopped at, if there is anything new and finite to see."""
        rows = [balance.before for balance in self.balances]
        if rows[0].time < self.time:  # no row was due at this step
            rows = [balance.row(self.time, self.step, self.time_step) for balance in self.balances]
            for writer in self.writers:
                writer.row(rows[0])
        if is_finite(rows[0]) and (not self.balance.rows or rows[0].time > self.balance.rows[-1].time):
            self._snapshot(rows)

    def _snapshot(self, rows: list[Row]) -> None:
        if self.writers:
            fields = self.model.method.snapshot()
            for writer in self.writers:
                writer.snapshot(rows[0].time, fields)
        for balance, row in zip(self.balances, rows, strict=True):
            balance.rows.append(row)
