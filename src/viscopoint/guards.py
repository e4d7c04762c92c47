"""What stops a run that has gone wrong, and how it says so."""

import math

from viscopoint.errors import ViscopointError
from viscopoint.inputs import Guards
from viscopoint.ledger import Row
from viscopoint.method import Method


class GuardError(ViscopointError):
    """A guard stopped the run; what was computed so far is kept."""


def check_row(row: Row, initial_energy: float, limits: Guards, method: Method) -> None:
    """Stop if a quantity is not finite or the energy ledger does not close."""
    for name, value in zip(row._fields, row, strict=True):
        if not math.isfinite(value):
            cause = method.advice.lost if row.lost else method.advice.unstable
            raise _stopped(row.time, f"{name} is not finite", cause)
    share = row.numerical / initial_energy
    if abs(share) > limits.energy_error:
        gone, cause = ("lost", method.advice.dissipating) if share > 0.0 else ("gained", method.advice.gaining)
        raise _stopped(
            row.time,
            f"the energy ledger does not close: {gone} {100 * abs(share):.1f} % of the initial kinetic energy "
            f"(guards.energy_error allows {100 * limits.energy_error:g} %)",
            cause,
        )


def check_step(time: float, first: float, limits: Guards, method: Method) -> None:
    """Stop if the stable step [ms] collapsed or is not a number."""
    step = method.stable_step()
    if step >= limits.smallest_step * first:
        return
    weakest = method.weakest()
    raise _stopped(
        time,
        f"the stable step fell to {step * 1e3:.3g} us, from {first * 1e3:.3g} us at the start "
        f"(guards.smallest_step allows a fall to {limits.smallest_step:g} of it)" + (f"; {weakest}" if weakest else ""),
        method.advice.collapsed,
    )


def _stopped(time: float, what: str, cause: str) -> GuardError:
    return GuardError(f"stopped at t = {time * 1e3:.4g} us: {what}. Likely cause: {cause}.")
