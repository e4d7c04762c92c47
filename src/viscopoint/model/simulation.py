"""Drives bodies through time: exact snapshot times, energy balances, guards, callbacks on their schedules."""

import math
import time as clock
from collections.abc import Iterable, Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from viscopoint.integrators.central_differences import CentralDifferences
from viscopoint.kernels.arrays import AnyArray
from viscopoint.kernels.jit import check_ready
from viscopoint.model.build import Model
from viscopoint.model.callbacks import Callback
from viscopoint.model.energy_balance import EnergyBalance, ReferenceEnergy, Row
from viscopoint.model.guards import GuardError, Guards, lost_in_words
from viscopoint.model.history import History
from viscopoint.model.schedule import EACH_STEP, SAME_TIME, merged
from viscopoint.results.interruption import Stop

LOSSES = "complete with losses"  # the status of a run that came to its end without some of its points or elements


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


class Progress(NamedTuple):
    """How far a simulation has come."""

    time: float  # ms
    step: int
    time_step: float  # ms
    busy: float  # s


class Simulation:
    """The bodies of a model on their way from the start of its case, or from a checkpoint, to the end.

    One step serves all, the shortest that any of them needs. Each has an energy balance of its own; what is written is
    the first body's, the rod's.
    """

    def __init__(self, model: Model, callbacks: Iterable[Callback] = (), stop: Stop | None = None) -> None:
        """Prepare to run a model; ``stop`` says when somebody wants to end it."""
        check_ready()  # the model may have been built before a fork
        case = model.case
        self.model, self.stop = model, stop or Stop()
        self.integrator = CentralDifferences(model.bodies)
        reference = ReferenceEnergy(model.bodies)
        self.balances = tuple(EnergyBalance(body, reference) for body in model.bodies)
        self.history = History(case.output.history or EACH_STEP, self.balances)
        self.callbacks = (self.history, Guards(case.guards, model.bodies), *callbacks)
        self.time = self.time_before = self.time_step = self.busy = 0.0
        self.step = 0
        self._snapshots = case.time.snapshots
        self._instants = merged((*self._snapshots.instants(case.time.end), case.time.end))  # at which steps end
        self._exact = frozenset(self._instants)

    # --- what callbacks see ---

    @property
    def ended(self) -> bool:
        """Whether the run has come to its end."""
        return self.time >= self._instants[-1]

    @property
    def share(self) -> float:
        """How much of the run's time has passed, of 1."""
        return self.time / self._instants[-1]

    @property
    def has_new_row(self) -> bool:
        """Whether the history has a row of this step."""
        return len(self.history) > 0 and self.history.newest.step == self.step

    @property
    def at_snapshot(self) -> bool:
        """Whether all fields are to be kept now."""
        steps = self._snapshots.steps
        return self.step == 0 or self.time in self._exact or bool(steps and self.step % steps == 0)

    # --- the run ---

    @np.errstate(all="ignore")  # guards tell what is not finite, once
    def run(self) -> Outcome:
        """Run to the end of the case; a guard or an interruption ends it earlier, and all up to then is kept."""
        status, reason = "complete", ""
        for callback in self.callbacks:
            callback.begin(self)
        try:
            self._go()
        except GuardError as error:
            status, reason = "stopped", str(error)
            for callback in self.callbacks:
                callback.stopped(self)
        except KeyboardInterrupt:
            status, reason = "interrupted", f"interrupted after t = {self.time * 1e3:.4g} us"
        lossy = [balance for balance in self.balances if balance.before.lost]
        if status == "complete" and lossy:
            told = [lost_in_words(balance.before, balance.start.mass, balance.method) for balance in lossy]
            status, reason = LOSSES, "; ".join(told)
        signal = self.stop.asked if status == "interrupted" else ""  # one that came in the last step changes nothing
        rows, errors = self.history.of_snapshots(), self.balances[0].errors
        return Outcome(status, reason, signal, rows, self.step, self.busy, *errors)

    def _go(self) -> None:
        if self.step == 0:
            self._call(self.callbacks)
        for instant in self._instants:
            while self.time < instant:
                began = clock.perf_counter()
                self._advance_towards(instant)
                self._call(self.callbacks[:2])  # history and guards
                self.busy += clock.perf_counter() - began if self.step > 1 else 0.0
                self._call(self.callbacks[2:])
                if self.stop.asked:
                    raise KeyboardInterrupt

    def _call(self, callbacks: Sequence[Callback]) -> None:
        for callback in callbacks:
            if callback.due(self):
                callback(self)

    def _advance_towards(self, instant: float) -> None:
        """Take one step of those, of equal length as far as the stable step allows, that end exactly at an instant."""
        left = math.ceil((instant - self.time) / self.stable_step() * (1 - SAME_TIME))
        dt = (instant - self.time) / max(left, 1)
        self.integrator.advance(dt)
        self.time_before, self.time = self.time, instant if left <= 1 else self.time + dt
        self.step, self.time_step = self.step + 1, dt

    def stable_step(self) -> float:
        """Return the longest step that all bodies can take next [ms]."""
        return min(body.stable_step() for body in self.model.bodies)

    # --- checkpoints ---

    def snapshots_until(self, time: float) -> list[float]:
        """Return the times of the snapshots up to a time, from the start on, but for those by steps [ms]."""
        return [0.0, *(instant for instant in self._instants if instant <= time)]

    @property
    def progress(self) -> Progress:
        """How far it has come."""
        return Progress(self.time, self.step, self.time_step, self.busy)

    def state(self) -> dict[str, AnyArray]:
        """Return all that ``restore`` needs, named "0.stress" for the first body, "history.rows" for a callback."""
        parts = [(str(number), body.state()) for number, body in enumerate(self.model.bodies)]
        parts += [(callback.name, callback.state()) for callback in self.callbacks]
        return {f"{part}.{name}": values for part, state in parts for name, values in state.items()}

    def restore(self, progress: Progress, state: Mapping[str, AnyArray]) -> None:
        """Go on from where a simulation of the same model by the same version stood.

        Raises:
            ValueError: it is none.
        """
        if not 0.0 <= progress.time <= self._instants[-1]:
            raise ValueError("its time is none of the case")
        self.time, self.step, self.time_step, self.busy = progress
        for callback in self.callbacks:
            callback.restore(_part(state, callback.name), self)
        for number, body in enumerate(self.model.bodies):
            body.restore(_part(state, str(number)))


def _part(state: Mapping[str, AnyArray], name: str) -> dict[str, AnyArray]:
    """Return what a state has under the name of a body or a callback."""
    return {key.removeprefix(f"{name}."): values for key, values in state.items() if key.startswith(f"{name}.")}
