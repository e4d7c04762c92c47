"""What is done in the course of a run beside the steps: measurements, guards, outputs, checkpoints, progress."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from viscopoint.kernels.arrays import AnyArray
from viscopoint.model.schedule import EACH_STEP, Schedule

if TYPE_CHECKING:
    from viscopoint.model.simulation import Simulation


class Callback:
    """Called at the start, at the end, and in between when its schedule says so; derive from it and write ``__call__``.

    Callbacks are called one after the other, in the order in which a simulation has them. What one keeps from call to
    call belongs into ``state``, so that a run can be resumed from a checkpoint.
    """

    name = ""  # under which a checkpoint keeps its state
    schedule: Schedule = EACH_STEP

    def due(self, simulation: "Simulation") -> bool:
        """Return whether to call it after the step just taken."""
        return simulation.ended or self.schedule.due(simulation.time_before, simulation.time, simulation.step)

    def begin(self, simulation: "Simulation") -> None:
        """Get ready to run from the start, or to go on from where ``restore`` left the simulation."""

    def __call__(self, simulation: "Simulation") -> None:
        """Do it; the simulation shows its bodies, its time and step, and its history so far."""
        raise NotImplementedError

    def stopped(self, simulation: "Simulation") -> None:
        """Keep what there is to see of a run that a guard has stopped."""

    def state(self) -> Mapping[str, AnyArray]:
        """Return what ``restore`` needs to go on."""
        return {}

    def restore(self, state: Mapping[str, AnyArray], simulation: "Simulation") -> None:
        """Take over a state; time, step and history of the simulation are what they were. Nothing is written yet.

        Raises:
            ValueError: it is no state of this run, or what was written does not go with it.
        """

    def close(self) -> None:
        """Finish: the run has ended, however it did."""


class OnRows(Callback):
    """Called with each new row of the history."""

    def due(self, simulation: "Simulation") -> bool:
        return simulation.has_new_row


class OnSnapshots(Callback):
    """Called when all fields are to be kept."""

    def due(self, simulation: "Simulation") -> bool:
        return simulation.at_snapshot
