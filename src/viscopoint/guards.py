"""What stops a run that has gone wrong, and how it says so."""

import math

from viscopoint.errors import ViscopointError
from viscopoint.inputs import Guards
from viscopoint.ledger import Row


class GuardError(ViscopointError):
    """A guard stopped the run; what was computed so far is kept."""


def check_row(row: Row, initial_energy: float, limits: Guards) -> None:
    """Stop if a quantity is not finite or the energy ledger does not close."""
    for name, value in zip(row._fields, row, strict=True):
        if not math.isfinite(value):
            raise _stopped(
                row.time,
                f"{name} is not finite",
                f"{row.points_lost} points left the box; give it more room (method.box)"
                if row.points_lost
                else "the integration became unstable; take a smaller method.safety, or the scheme 'musl' instead of "
                "'usl', whose nodes of nearly no mass run away",
            )
    share = row.numerical / initial_energy
    if abs(share) > limits.energy_error:
        gone, cause = (
            (
                "lost",
                "the transfers dissipate (method.pic_fraction), or the integration is becoming unstable (scheme 'usl' "
                "does where points come to nodes of nearly no mass; 'musl' does not)",
            )
            if share > 0.0
            else ("gained", "noise of points that cross cells, or steps too long; take a smaller method.safety")
        )
        raise _stopped(
            row.time,
            f"the energy ledger does not close: {gone} {100 * abs(share):.1f} % of the initial kinetic energy "
            f"(guards.energy_error allows {100 * limits.energy_error:g} %)",
            cause,
        )


def check_step(time: float, step: float, first: float, limits: Guards) -> None:
    """Stop if the stable step [ms] collapsed or is not a number."""
    if not step >= limits.smallest_step * first:
        raise _stopped(
            time,
            f"the stable step fell to {step * 1e3:.3g} us, from {first * 1e3:.3g} us at the start "
            f"(guards.smallest_step allows a fall to {limits.smallest_step:g} of it)",
            "points fly apart or are crushed: the integration became unstable, or the impact is too violent for this "
            "resolution; look at the last snapshot",
        )


def _stopped(time: float, what: str, cause: str) -> GuardError:
    return GuardError(f"stopped at t = {time * 1e3:.4g} us: {what}. Likely cause: {cause}.")
