"""The face that the driver, the ledger and the outputs see of any method, MPM or FEM."""

from typing import NamedTuple, Protocol

from viscopoint.arrays import Array, Rows


class Field(NamedTuple):
    """Named values for output, one row per point."""

    values: Rows
    unit: str


class Totals(NamedTuple):
    """Sums over the whole body, and what boundaries did to it since the start."""

    kinetic: float  # mJ
    stored: float  # mJ
    dissipated: float  # by the law, mJ
    viscous: float  # by the bulk viscosity, mJ
    contact: float  # taken by the wall's normal impulse (nodes stop as they touch), mJ
    friction: float  # taken by the wall's tangential impulse, mJ
    momentum: Array  # [3], N ms
    impulse: Array  # [3], of the boundaries on the body, N ms
    mass: float  # g


class Method(Protocol):
    """An explicit method that advances a body in time."""

    def stable_step(self) -> float:
        """Return the longest step to take next, safety factor included [ms]."""
        ...

    def advance(self, dt: float) -> None:
        """Advance the body by ``dt`` [ms]."""
        ...

    def totals(self) -> Totals:
        """Return energies, momentum and impulse."""
        ...

    def positions(self) -> Array:
        """Return where the body's points are, ``[p, 3]`` [mm]; not-a-number for those that were lost."""
        ...

    def lost(self) -> int:
        """Return how many points left the region that the method covers."""
        ...

    def snapshot(self) -> dict[str, Field]:
        """Return all fields worth looking at."""
        ...

    def state(self) -> dict[str, Rows]:
        """Return exactly what ``restore`` needs to go on as if nothing had happened."""
        ...

    def restore(self, state: dict[str, Rows]) -> None:
        """Take over a state."""
        ...
