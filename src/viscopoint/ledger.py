"""Energy, momentum and shape, measured on any method: one row of the history."""

from typing import NamedTuple

from viscopoint.body import Surface
from viscopoint.gauges import measure
from viscopoint.method import Method, Totals


class Row(NamedTuple):
    """The state of a run at one time; ``UNITS`` has the unit of each entry.

    Energies close by construction: ``numerical`` is what the initial kinetic energy exceeds the sum of the others by,
    and so what transfers and time integration lost (or, below zero, gained).
    """

    time: float
    step: int
    time_step: float  # that the method took last
    length: float
    foot_radius: float
    greatest_radius: float
    lowest_point: float
    highest_point: float
    widest_point: float
    velocity: float  # of the centre of mass, along z
    momentum: float  # along z
    wall_force: float  # along z, mean since the row before
    wall_impulse: float  # along z, since the start
    momentum_error: float  # greatest component of momentum gained less impulse received
    kinetic: float
    stored: float
    dissipated: float  # by the law
    viscous: float  # by the bulk viscosity
    contact: float  # taken by the wall's normal impulse
    friction: float  # taken by the wall's tangential impulse
    numerical: float  # the remainder
    points_lost: int


UNITS = Row(
    time="ms", step="1", time_step="ms",
    length="mm", foot_radius="mm", greatest_radius="mm", lowest_point="mm", highest_point="mm", widest_point="mm",
    velocity="m/s", momentum="N ms", wall_force="N", wall_impulse="N ms", momentum_error="N ms",
    kinetic="mJ", stored="mJ", dissipated="mJ", viscous="mJ", contact="mJ", friction="mJ", numerical="mJ",
    points_lost="1",
)._asdict()  # pyright: ignore[reportArgumentType]  # fmt: skip


class Ledger:
    """Keeps the account of a run: what there was at the start, and the row before."""

    def __init__(self, method: Method, surface: Surface) -> None:
        self.method, self.surface = method, surface
        self.start: Totals = method.totals()
        self.before: Row = self.row(0.0, 0, 0.0)

    def row(self, time: float, step: int, time_step: float) -> Row:
        """Measure the method now."""
        now, start = self.method.totals(), self.start
        shape = measure(self.surface, self.method.positions())
        known = now.kinetic + now.stored + now.dissipated + now.viscous + now.contact + now.friction
        impulse = float(now.impulse[2])
        force = (impulse - self.before.wall_impulse) / (time - self.before.time) if step else 0.0
        row = Row(
            time, step, time_step, *shape,
            velocity=float(now.momentum[2]) / now.mass,
            momentum=float(now.momentum[2]),
            wall_force=force,
            wall_impulse=impulse,
            momentum_error=float(abs(now.momentum - start.momentum - now.impulse).max()),
            kinetic=now.kinetic, stored=now.stored, dissipated=now.dissipated,
            viscous=now.viscous, contact=now.contact, friction=now.friction,
            numerical=start.kinetic + start.stored - known,
            points_lost=self.method.lost(),
        )  # fmt: skip
        self.before = row
        return row
