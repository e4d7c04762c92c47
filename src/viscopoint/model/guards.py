"""What stops a run that has gone wrong, and how it says so."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from viscopoint.case.tables import Guards as Limits
from viscopoint.errors import ViscopointError
from viscopoint.model.callbacks import Callback
from viscopoint.model.energy_balance import MEASURED, ReferenceEnergy, Row
from viscopoint.model.method import Method, Totals

if TYPE_CHECKING:
    from viscopoint.model.simulation import Simulation

ROUNDING = 1e-9  # of sums of masses: all that there is is no more than 100 %


class GuardError(ViscopointError):
    """A guard stopped the run; what was computed so far is kept."""


class Guards(Callback):
    """Looks at each row, and at the stable step after each step."""

    def __init__(self, limits: Limits, bodies: Sequence[Method]) -> None:
        self.limits, self.first_steps = limits, [body.stable_step() for body in bodies]

    def __call__(self, simulation: "Simulation") -> None:
        for balance in simulation.balances if simulation.has_new_row else ():
            check_row(balance.before, balance.start, balance.reference, self.limits, balance.method)
        for balance, first in zip(simulation.balances, self.first_steps, strict=True):
            check_step(simulation.time, first, self.limits, balance.method)


def check_row(row: Row, start: Totals, reference: ReferenceEnergy, limits: Limits, method: Method) -> None:
    """Stop if a quantity is not finite, energy is lost or gained, or too much is eroded or taken by hourglassing.

    Args:
        row: to check.
        start: energies and mass at the start.
        reference: the energy of which shares are taken.
        limits: what the case allows.
        method: what moves the body.
    """
    _check_finite(row, method)
    missing, eroded = row.numerical / reference.energy, row.eroded / reference.energy
    if abs(missing) > limits.energy_error:
        gone, cause = (
            ("lost", method.failure_hints.dissipating) if missing > 0.0 else ("gained", method.failure_hints.gaining)
        )
        raise _stopped(
            row.time,
            f"the energy balance does not close: {gone} {100 * abs(missing):.1f} % of {reference.of} "
            f"(guards.energy_error allows {100 * limits.energy_error:g} %)",
            cause,
        )
    if max(row.lost_mass / start.mass, eroded) > limits.lost_share * (1.0 + ROUNDING):
        stored = f" and {100 * eroded:.2g} % of {reference.of}" if row.eroded else ""
        allowed = f" (guards.lost_share allows {100 * limits.lost_share:g} %)"
        raise _stopped(row.time, lost_in_words(row, start.mass, method) + stored + allowed, method.failure_hints.lost)
    if row.hourglass_share > 100 * limits.hourglass_share:
        raise _stopped(
            row.time,
            f"hourglass control took {row.hourglass_share:.1f} % of the internal energy "
            f"(guards.hourglass_share allows {100 * limits.hourglass_share:g} %)",
            method.failure_hints.hourglassing,
        )


def is_finite(row: Row) -> bool:
    """Return whether a row holds numbers, but for lengths where points were lost."""
    return _not_finite(row) is None


def lost_in_words(row: Row, mass: float, method: Method) -> str:
    """Say what left the box or was deleted, of a body of some mass [g]."""
    return f"{row.lost} {method.failure_hints.losses}, {100 * row.lost_mass / mass:.3g} % of the mass"


def _check_finite(row: Row, method: Method) -> None:
    if name := _not_finite(row):
        cause = method.failure_hints.lost if row.lost else method.failure_hints.unstable
        raise _stopped(row.time, f"{name} is not finite", cause)


def _not_finite(row: Row) -> str | None:
    """Return the first quantity that is not finite and should be."""
    excused = MEASURED if row.lost else ()
    quantities = zip(row._fields, row, strict=True)
    return next((name for name, value in quantities if not math.isfinite(value) and name not in excused), None)


def check_step(time: float, first: float, limits: Limits, method: Method) -> None:
    """Stop if the stable step [ms] collapsed or is not a number."""
    step = method.stable_step()
    if step >= limits.smallest_step * first:
        return
    limiting = method.limiting_element()
    raise _stopped(
        time,
        f"the stable step fell to {step * 1e3:.3g} us, from {first * 1e3:.3g} us at the start "
        f"(guards.smallest_step allows a fall to {limits.smallest_step:g} of it)"
        + (f"; {limiting}" if limiting else ""),
        method.failure_hints.collapsed,
    )


def _stopped(time: float, what: str, cause: str) -> GuardError:
    return GuardError(f"stopped at t = {time * 1e3:.4g} us: {what}. Likely cause: {cause}.")
