"""Energy, momentum and shape, measured on any method: one row of the history."""

from collections.abc import Sequence
from typing import Annotated, NamedTuple, get_type_hints

import numpy as np

from viscopoint.kernels.jit import called, serial_kernel
from viscopoint.model import measurements
from viscopoint.model.body import Surface
from viscopoint.model.measurements import Measurements
from viscopoint.model.method import Method, Totals

Time = Annotated[float, "ms"]
Length = Annotated[float, "mm"]
Speed = Annotated[float, "m/s"]
Force = Annotated[float, "N"]
Impulse = Annotated[float, "N ms"]
Energy = Annotated[float, "mJ"]
Mass = Annotated[float, "g"]
Percent = Annotated[float, "%"]
Count = Annotated[int, "1"]


class Row(NamedTuple):
    """The state of a run at one time; ``UNITS`` has the unit of each entry.

    Energies close by construction: ``numerical`` is what the initial energy exceeds the sum of the others by, and so
    what transfers and time integration lost (or, below zero, gained). A wall at rest does no work: ``contact`` is the
    kinetic energy of the nodes that it stops, a loss of the method of first order in the cell or element. The work of
    a plane that moves is in it too, below zero. Points that left the box keep the energy and momentum they had, and
    count; so do the nodes of deleted elements. Lengths that need a point which was lost are not a number.

    ``hourglass_share`` is ``hourglass`` over the greatest internal energy so far, stored and dissipated by the law, or
    over a hundredth of the ``ReferenceEnergy`` as long as that is more.
    """

    time: Time
    step: Count
    time_step: Time  # that the method took last
    length: Length
    contact_radius: Length  # of what is on the wall, or lowest; see ``measurements``
    impact_face_radius: Length  # of the lowest layer of material
    greatest_radius: Length
    lowest_point: Length
    highest_point: Length
    widest_point: Length
    velocity: Speed  # of the centre of mass, along z
    momentum: Impulse  # along z
    wall_force: Force  # along z, mean since the row before
    wall_impulse: Impulse  # along z, since the start
    momentum_error: Impulse  # greatest component of momentum gained less impulse received
    kinetic: Energy
    stored: Energy
    dissipated: Energy  # by the law
    hypoelastic: Energy  # taken by the law (below zero: given) as volume changes under shear; it has no potential
    viscous: Energy  # by the bulk viscosity
    hourglass: Energy  # taken by the control of hourglass modes (FEM)
    eroded: Energy  # stored in elements when they were deleted (FEM)
    contact: Energy  # taken by the wall's normal impulse
    friction: Energy  # taken by the wall's tangential impulse
    numerical: Energy  # the remainder
    hourglass_share: Percent
    lost: Count  # points that left the box (MPM), elements deleted (FEM)
    lost_mass: Mass  # of those


UNITS: dict[str, str] = {name: hint.__metadata__[0] for name, hint in get_type_hints(Row, include_extras=True).items()}


def row_of(values: Sequence[float]) -> Row:
    """Return a row of numbers that were one; raise ``ValueError`` if they were not."""
    return Row._make(kind(value) for kind, value in zip(_KINDS, values, strict=True))


MEASURED = Measurements._fields  # not a number where a point that they need was lost
LEAST_INTERNAL = 0.01  # of the reference energy, of which ``hourglass_share`` is at least taken
ROUNDED = 1e-9  # a strain that says nothing
_KINDS = [int if unit == "1" else float for unit in UNITS.values()]


for _loop in measurements.LOOPS:
    called(_loop)
measured = serial_kernel(measurements.measured)


class ReferenceEnergy:
    """The energy of which errors and losses are shares: all that was brought in, to all bodies.

    It is what the bodies had at the start, or, if that is more, the work that planes have done since. A plane that
    strikes a body at rest is the same impact as a body that strikes a plane at rest: the reference is no less than the
    energy of the bodies at the speed of the fastest plane, so that losses in the first cells of a pulse are the same
    share in both. Nor is it less than the energy of a strain that is nothing but rounding.
    """

    def __init__(self, bodies: Sequence[Method]) -> None:
        """Measure the bodies at the start."""
        self._bodies, starts = bodies, [body.totals() for body in bodies]
        fastest = max((abs(each.plane.speed) for body in bodies for each in body.interactions), default=0.0)
        stiffness = sum(body.material.p_wave_modulus * float(body.body.volume.sum()) for body in bodies)
        self.energy, self.of = max(  # mJ; it never falls
            (sum(start.kinetic + start.stored for start in starts), "the initial kinetic energy"),
            (0.5 * fastest**2 * sum(start.mass for start in starts), "the energy of the moving planes"),
            (0.5 * ROUNDED**2 * stiffness, f"the energy of a strain of {ROUNDED:g}"),
        )

    def update(self) -> None:
        """Take in the work that was done since."""
        self.restore(sum(body.external_work for body in self._bodies))

    def restore(self, work: float) -> None:
        """Take over what was brought in earlier, if that is more [mJ]."""
        if work > self.energy:
            self.energy, self.of = work, "the work done so far"


class EnergyBalance:
    """Keeps the account of a body: what there was at the start, the row before, and the greatest errors."""

    def __init__(self, method: Method, reference: ReferenceEnergy) -> None:
        """Measure a body at the start; ``reference`` is that of all bodies."""
        self.method, self.reference, surface = method, reference, method.body.surface
        away = np.linalg.norm(method.body.position[surface.impact_face[:, 0], :2], axis=1)
        self.surface = Surface(
            ring=np.ascontiguousarray(surface.ring), start=np.ascontiguousarray(surface.start),
            radius=float(surface.radius), rear_face=surface.rear_face,
            impact_face=surface.impact_face[np.argsort(away, kind="stable")],
            end_overhang=float(surface.end_overhang),
            contact_height=float(surface.contact_height),
        )  # fmt: skip
        self.variance, self._room = float(np.var(surface.start)), measurements.room(surface)
        self.start: Totals = method.totals()
        self.internal = 0.0  # the greatest so far, mJ
        self.before: Row = self.row(0.0, 0, 0.0)
        self.errors = (0.0, 0.0, 0.0)  # of energy and momentum, and the share of hourglass energy: the greatest so far

    def account(self) -> list[float]:
        """Return what ``restore`` needs beside the newest row."""
        return [*self.start.flat(), self.internal, *self.errors, self.reference.energy]

    def restore(self, account: Sequence[float], newest: Row) -> None:
        """Take over the account of a run that was begun earlier.

        Raises:
            ValueError: the run did not begin as this one, or there was no such account.
        """
        *start, self.internal, energy, momentum, hourglass, reference = account
        if not np.allclose(start, self.start.flat(), rtol=1e-9):
            raise ValueError("it does not begin as the case does")
        if not (np.isfinite(account).all() and min(self.internal, energy, momentum, hourglass) >= 0.0):
            raise ValueError("its energy balance is none")
        self.start, self.errors, self.before = Totals.of_flat(start), (energy, momentum, hourglass), newest
        self.reference.restore(reference)

    def record(self, time: float, step: int, time_step: float) -> Row:
        """Measure the body now, and note how far the account is off."""
        row = self.row(time, step, time_step)
        now = (abs(row.numerical) / self.reference.energy, row.momentum_error, row.hourglass_share)
        self.errors = tuple(map(max, self.errors, now))
        return row

    def row(self, time: float, step: int, time_step: float) -> Row:
        """Measure the method now."""
        now, start, lost = self.method.totals(), self.start, self.method.lost()
        shape = Measurements(*measured(self.surface, self.method.positions(), self.variance, self._room))
        impulse = float(now.impulse[2])
        self.reference.update()
        self.internal = max(self.internal, LEAST_INTERNAL * self.reference.energy, now.stored + now.dissipated)
        force = (impulse - self.before.wall_impulse) / (time - self.before.time) if step else 0.0
        row = Row(
            time, step, time_step, *shape,
            velocity=float(now.momentum[2]) / now.mass,
            momentum=float(now.momentum[2]),
            wall_force=force,
            wall_impulse=impulse,
            momentum_error=float(abs(now.momentum - start.momentum - now.impulse).max()),
            kinetic=now.kinetic, stored=now.stored, dissipated=now.dissipated,
            hypoelastic=now.hypoelastic, viscous=now.viscous, hourglass=now.hourglass, eroded=now.eroded,
            contact=now.contact, friction=now.friction,
            numerical=start.energy - now.energy,
            hourglass_share=100.0 * now.hourglass / self.internal,
            lost=lost,
            lost_mass=self.method.lost_mass() if lost else 0.0,
        )  # fmt: skip
        self.before = row
        return row
