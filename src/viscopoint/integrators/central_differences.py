"""Central differences (velocity Verlet), staged over all bodies: one step, and one solution of all constraints.

Velocities are known at the same times as positions. Half a step's force changes velocities, these move the nodes, the
strain of the step gives the new force, and the other half of the step's force changes velocities once more.
Constraints act on both halves: what would pass a wall arrives exactly on it, and what stands on one does not move into
it. A body of material points has grid velocities in the place of the nodes', and all of its kick in the first half.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Protocol

import numpy as np

from viscopoint.interactions.rows import REACTIONS, Rows, empty_rows, fix_active_set, solve
from viscopoint.kernels.arrays import Array


class Body(Protocol):
    """What the integrator asks of a body; ``number`` is the body's in the rows."""

    @property
    def reactions(self) -> Array:
        """What each interaction did to the body since the start (``interactions.rows.REACTIONS``)."""
        ...

    @reactions.setter
    def reactions(self, place: Array) -> None: ...

    def kick(self, dt: float) -> None:
        """Give velocities the impulse of the forces, in the first half of a step."""
        ...

    def constrain(self, rows: Rows, number: int, first: int, dt: float) -> Rows:
        """Add the rows of what acts on the body; its interactions are numbered from ``first`` on."""
        ...

    def drift(self, rows: Rows, number: int, dt: float) -> None:
        """Take the velocities that the rows leave, and move with them."""
        ...

    def strain(self, dt: float) -> None:
        """Take the motion over the step to strain, stress and force."""
        ...

    def kick_again(self, dt: float) -> None:
        """Give velocities the impulse of the forces, in the second half of a step."""
        ...

    def constrain_again(self, rows: Rows, number: int, dt: float) -> None:
        """Bring the rows' velocities up to date."""
        ...

    def correct_velocity(self, rows: Rows, number: int) -> None:
        """Take the velocities that the rows leave."""
        ...


class CentralDifferences:
    """Bodies that advance together; the rows of constraints live for one step."""

    def __init__(self, bodies: Sequence[Body]) -> None:
        self.bodies = tuple(bodies)
        self._first: list[int] = np.cumsum([0, *(len(body.reactions) for body in bodies)]).tolist()
        self._rows = empty_rows(0)
        self._reactions = np.zeros((self._first[-1], REACTIONS))
        for number, body in enumerate(self.bodies):  # what each is told of is its part of this array
            part = self._reactions[self._first[number] : self._first[number + 1]]
            part[:] = body.reactions
            body.reactions = part

    def drives(self, body: Body) -> bool:
        """Return whether a body's reactions are still told here, and not to another integrator that took it over."""
        return any(body is one and body.reactions.base is self._reactions for one in self.bodies)

    def advance(self, dt: float) -> None:
        """Advance all bodies by one step ``dt`` [ms]."""
        bodies, first, rows = self.bodies, self._first, self._rows
        rows.size[:], ends = 0, [0]
        for body in bodies:
            body.kick(dt)  # v += f/m Δt/2
        for number, body in enumerate(bodies):
            rows = body.constrain(rows, number, first[number], dt)  # what nodes must not do
            ends.append(int(rows.size[0]))
        self._solve(rows, ends)  # λ >= 0, friction cone
        for number, body in enumerate(bodies):
            body.drift(rows, number, dt)  # x += v Δt
        for body in bodies:
            body.strain(dt)  # Δε, ΔR -> material -> σ, f
        for body in bodies:
            body.kick_again(dt)  # v += f/m Δt/2
        for number, body in enumerate(bodies):
            body.constrain_again(rows, number, dt)
        if rows.size[0]:
            fix_active_set(rows)
        self._solve(rows, ends)
        for number, body in enumerate(bodies):
            body.correct_velocity(rows, number)
        self._rows = rows

    def _solve(self, rows: Rows, ends: list[int]) -> None:
        """Solve the rows of each body, none of which shares a node with another's."""
        for begin, end in pairwise(ends):
            if begin < end:
                solve(rows, begin, end, self._reactions)
