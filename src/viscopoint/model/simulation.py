"""Drives any method through time: exact snapshot times, ledger, guards, outputs."""

import math
import time as clock
from collections.abc import Callable, Sequence
from typing import Literal, NamedTuple

import numpy as np

from viscopoint.kernels.jit import check_ready
from viscopoint.model.build import Model
from viscopoint.model.energy_balance import Ledger, Row, row_of
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
    wall_time: float  # s, of the steps and the ledger, less the first step, which may compile
    energy_error: float  # greatest share of the initial energy that was ever missing
    momentum_error: float  # greatest difference ever of momentum gained and impulse received, N ms
    hourglass_share: float  # greatest ever, %


class Simulation:
    """A model on its way from the start of its case, or from a checkpoint, to the end."""

    def __init__(
        self,
        model: Model,
        writers: Sequence[Writer] = (),
        watch: Watch | None = None,
        keeper: Keeper | None = None,
        stop: Stop | None = None,
    ) -> None:
        """Prepare to run a model; ``keeper`` writes checkpoints, ``stop`` says when somebody wants to end it."""
        check_ready()  # the model may have been built before a fork
        self.model, self.writers, self.watch = model, writers, watch
        self.keeper, self.stop = keeper, stop or Stop()
        self.ledger = Ledger(model.method, model.body.surface)
        self.time, self.step, self.time_step, self.busy = 0.0, 0, 0.0, 0.0
        self.rows: list[Row] = []
        self.errors = (0.0, 0.0, 0.0)  # of energy and momentum, and the share of hourglass energy: the greatest so far
        self.first_step = model.method.stable_step()

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
        if status == "complete" and self.ledger.before.lost:
            status, reason = LOSSES, lost_in_words(self.ledger.before, self.ledger.start.mass, self.model.method)
        signal = self.stop.asked if status == "interrupted" else ""  # one that came in the last step changes nothing
        return Outcome(status, reason, signal, self.rows, self.step, self.busy, *self.errors)

    def _go(self) -> None:
        if not self.rows:
            self._snapshot(self._record(0.0))
        check_step(self.time, self.first_step, self.model.case.guards, self.model.method)
        for instant in self._instants()[len(self.rows) - 1 :]:
            self._snapshot(self._advance_to(instant))

    def resume(self, checkpoint: Checkpoint) -> None:
        """Go on from a checkpoint of the same model by the same version; raise ``ValueError`` if it is none."""
        progress = checkpoint.progress
        rows = [row_of(values) for values in progress.rows]
        instants, newest = [0.0, *self._instants()], row_of(progress.before)
        ordered = rows[-1].time <= newest.time <= progress.time <= instants[-1]
        if not all(map(is_finite, (*rows, newest))):
            raise ValueError("its numbers are not finite")
        if [row.time for row in rows] != instants[: len(rows)] or not ordered:
            raise ValueError("its times are not those of the case")
        if not np.allclose(progress.start, self.ledger.start.flat(), rtol=1e-9):
            raise ValueError("it does not begin as the case does")
        self.model.method.restore(checkpoint.state)
        self.ledger.restore(progress.start, progress.before, progress.internal)
        self.time, self.step, self.time_step = progress.time, progress.step, progress.time_step
        self.busy, self.errors = progress.busy, progress.errors
        self.rows = rows

    def _checkpoint(self) -> None:
        if self.keeper is None:
            return
        self.keeper.write(
            self.model.method.state(),
            time=self.time, step=self.step, time_step=self.time_step, busy=self.busy, errors=self.errors,
            start=self.ledger.start.flat(), before=list(self.ledger.before), internal=self.ledger.internal,
            rows=[list(row) for row in self.rows],
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

    def _advance_to(self, instant: float) -> Row:
        """Step to an instant exactly, in steps of equal length as far as the stable step allows."""
        method, case = self.model.method, self.model.case
        row, between = self.ledger.before, case.output.history_interval or 0.0
        while self.time < instant:
            began = clock.perf_counter()
            left = math.ceil((instant - self.time) / method.stable_step() * (1 - SAME_TIME))
            dt = (instant - self.time) / max(left, 1)
            method.advance(dt)
            self.time = instant if left <= 1 else self.time + dt
            self.step, self.time_step = self.step + 1, dt
            if left <= 1 or self.time - row.time >= between:
                row = self._record(dt)
            check_step(self.time, self.first_step, case.guards, method)
            self.busy += clock.perf_counter() - began if self.step > 1 else 0.0
            if self.stop.asked or (self.keeper and self.keeper.due(self.time)):
                self._checkpoint()
            if self.stop.asked:
                raise KeyboardInterrupt
        return row

    def _record(self, dt: float) -> Row:
        """Measure, hand the row to all who want it, and let the guards look at it."""
        row = self.ledger.row(self.time, self.step, dt)
        for writer in self.writers:
            writer.row(row)
        if self.watch:
            self.watch(self.time / self.model.case.time.end, row)
        start = self.ledger.start
        now = (abs(row.numerical) / (start.kinetic + start.stored), row.momentum_error, row.hourglass_share)
        self.errors = tuple(map(max, self.errors, now))
        check_row(row, start, self.model.case.guards, self.model.method)
        return row

    def _keep_last_state(self) -> None:
        """Keep what a guard stopped at, if there is anything new and finite to see."""
        row = self.ledger.before
        if row.time < self.time:  # no row was due at this step
            row = self.ledger.row(self.time, self.step, self.time_step)
            for writer in self.writers:
                writer.row(row)
        if is_finite(row) and (not self.rows or row.time > self.rows[-1].time):
            self._snapshot(row)

    def _snapshot(self, row: Row) -> None:
        fields = self.model.method.snapshot()
        for writer in self.writers:
            writer.snapshot(row.time, fields)
        self.rows.append(row)
