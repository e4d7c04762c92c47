"""The face that the driver, the energy balance and the outputs see of any method, MPM or FEM."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, NamedTuple, Protocol

import numpy as np

from viscopoint.kernels.arrays import AnyArray, Array

if TYPE_CHECKING:  # what reads fields needs no kernel
    from viscopoint.interactions.planes import Interaction
    from viscopoint.interactions.rows import Rows
    from viscopoint.materials import HistoryField, Material
    from viscopoint.model.body import Body


class Field(NamedTuple):
    """Named values for output, one row per point (material point or node) or per cell (finite element)."""

    values: AnyArray
    unit: str
    on: Literal["points", "cells"] = "points"


class Totals(NamedTuple):
    """Sums over the whole body, and what boundaries did to it since the start."""

    kinetic: float  # mJ
    stored: float  # mJ
    dissipated: float  # by the law, mJ
    hypoelastic: float  # taken by the law as volume changes under shear, mJ
    viscous: float  # by the bulk viscosity, mJ
    hourglass: float  # taken by the control of hourglass modes, mJ
    eroded: float  # stored in elements when they were deleted, mJ
    contact: float  # taken by the wall's normal impulse (nodes stop as they touch), mJ
    friction: float  # taken by the wall's tangential impulse, mJ
    momentum: Array  # [3], N ms
    impulse: Array  # [3], of the boundaries on the body, N ms
    mass: float  # g

    @property
    def energy(self) -> float:
        """Return the sum of all energies, which nothing but numerical error changes [mJ]."""
        return (
            self.kinetic + self.stored + self.dissipated + self.hypoelastic + self.viscous + self.hourglass
            + self.eroded + self.contact + self.friction
        )  # fmt: skip

    def flat(self) -> list[float]:
        """Return all numbers in a row."""
        return np.hstack(self).tolist()

    @classmethod
    def of_flat(cls, numbers: Sequence[float]) -> "Totals":
        """Return what gave these numbers."""
        *energies, m0, m1, m2, i0, i1, i2, mass = numbers
        return cls._make([*energies, np.array([m0, m1, m2]), np.array([i0, i1, i2]), mass])


class FailureHints(NamedTuple):
    """What a method is likely to suffer from, in the words of a guard that stops it."""

    lost: str  # too much left the box, or was deleted
    unstable: str  # a quantity is not finite
    dissipating: str  # energy is lost
    gaining: str  # energy is gained
    collapsed: str  # the stable step became tiny
    hourglassing: str = ""  # the control of hourglass modes took much of the internal energy; empty: there are none
    losses: str = "points lost"  # what is counted as lost


class Method(Protocol):
    """An explicit method that advances a body in time, in the stages of an integrator (``integrators``)."""

    @property
    def body(self) -> "Body":
        """Where the body is at the start."""
        ...

    @property
    def material(self) -> "Material":
        """What it is of."""
        ...

    @property
    def interactions(self) -> "Sequence[Interaction]":
        """What acts on it from outside."""
        ...

    @property
    def external_work(self) -> float:
        """What interactions did on the body since the start; below zero: what they took [mJ]."""
        ...

    @property
    def reactions(self) -> Array:
        """What each interaction did to the body since the start (``interactions.rows.REACTIONS``)."""
        ...

    @reactions.setter
    def reactions(self, place: Array) -> None: ...

    @property
    def failure_hints(self) -> FailureHints:
        """What to say of this method when a guard stops it."""
        ...

    def stable_step(self) -> float:
        """Return the longest step to take next, ``time_step_factor`` included [ms]."""
        ...

    def kick(self, dt: float) -> None: ...
    def constrain(self, rows: "Rows", number: int, first: int, dt: float) -> "Rows": ...
    def drift(self, rows: "Rows", number: int, dt: float) -> None: ...
    def strain(self, dt: float) -> None: ...
    def kick_again(self, dt: float) -> None: ...
    def constrain_again(self, rows: "Rows", number: int, dt: float) -> None: ...
    def correct_velocity(self, rows: "Rows", number: int) -> None: ...

    def advance(self, dt: float) -> None:
        """Advance this body alone by ``dt`` [ms]."""
        ...

    def totals(self) -> Totals:
        """Return energies, momentum and impulse."""
        ...

    def positions(self) -> Array:
        """Return where the body's points are, ``[p, 3]`` [mm]; not-a-number for those that were lost."""
        ...

    def lost(self) -> int:
        """Return how many points left the region that the method covers, or elements were deleted."""
        ...

    def lost_mass(self) -> float:
        """Return the mass of what ``lost`` counts [g]."""
        ...

    def limiting_element(self) -> str:
        """Say what keeps the stable step short, and where; empty if there is nothing to say."""
        ...

    def snapshot(self) -> dict[str, Field]:
        """Return all fields worth looking at."""
        ...

    def state(self) -> dict[str, AnyArray]:
        """Return exactly what ``restore`` needs to go on as if nothing had happened.

        The arrays are the method's own, until the next step, and leave out what building the case anew gives.
        """
        ...

    def restore(self, state: dict[str, AnyArray]) -> None:
        """Take over a state: copy it into the method's own arrays."""
        ...


def history_fields(
    groups: "Sequence[HistoryField]", history: Array, on: Literal["points", "cells"] = "points"
) -> dict[str, Field]:
    """Return a material's history ``[row, h]`` as named fields."""
    fields, column = {}, 0
    for group in groups:
        values = history[:, column : column + group.components]
        fields[group.name] = Field(values[:, 0] if group.components == 1 else values, group.unit, on)
        column += group.components
    return fields


def von_mises_of(stress: Array) -> Array:
    """Return sqrt(3/2 S : S) of each row [MPa]."""
    shape = stress[:, :3] - stress[:, :3].mean(axis=1, keepdims=True)
    return np.sqrt(1.5 * (shape**2).sum(axis=1) + 3.0 * (stress[:, 3:] ** 2).sum(axis=1))
