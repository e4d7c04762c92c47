"""FMPM(k): the consistent mass matrix, inverted approximately (Nairn & Hammerquist 2021; XPIC(k): 2017).

    v = Σ_{j<k} (1 - S⁺S)^j u,    u_i = ((mv)_i + f_i Δt) / m_i,    v_p = Σ N v_i

with S the interpolation Σ N v_i to the points and S⁺ the average Σ N m_p v_p / m_i back. k = 1 is PIC; for k → ∞ the
nodes get (S⁺S)⁻¹ u, their velocity by the consistent mass matrix Σ_p m_p N_i N_j, of which S v is the best that nodes
can say of the points' velocities, and PIC's damping is gone: of a wave of which S⁺S leaves the share F, a step leaves
1 - (1 - F)^k.

Linear momentum is that of the lumped nodes, since no correction has any. Velocities are known between the steps here
(leapfrog), and so points move with the new one, not with the mean of old and new, which is for velocities known at
both ends of the step. Boundaries hold the corrected nodes. Strain is taken from momentum as it is mapped, by the lumped
mass: corrected too, it made the paper's foot stiffer and took twice the time.
"""

from typing import Any, NamedTuple

from numba import prange

from viscopoint.arrays import Array
from viscopoint.jit import implements, kernel
from viscopoint.mpm.grid import Grid, forget
from viscopoint.mpm.points import Points
from viscopoint.mpm.support import Support, around, sampled, spread, spread_with_force
from viscopoint.mpm.transfers import carry, give, give_with_force, offer, take
from viscopoint.slabs import COLOURS, PARTS, part_of
from viscopoint.tensors import Sym


@offer("fmpm")
class Fmpm(NamedTuple):
    """Points take the velocity of nodes whose mass matrix is nearly the consistent one."""

    order: int  # k, at least 1

    @classmethod
    def chosen(cls, pic: float, order: int) -> "Fmpm":
        return cls(order)

    @property
    def affine(self) -> bool:
        return False

    @property
    def spares(self) -> int:
        return 2

    @property
    def dissipates(self) -> str:
        return "FMPM forgets what the nodes do not see, its own loss; take a larger method.order"

    def correct(self, points: Points, grid: Grid, shape: Any) -> None:
        """Add the corrections of order 2 to k."""
        rest, seen = grid.spare
        rest[:] = grid.velocity
        for _ in range(self.order - 1):
            forget(seen)
            filter_nodes(points, grid, shape, rest, seen)
            grid.geometry.mirror(grid, seen)
            add_rest(grid, rest, seen)


@kernel
def filter_nodes(points: Points, grid: Grid, shape: Any, rest: Array, seen: Array) -> None:
    """Map Σ N m_p Σ N rest_i: what of the nodes' ``rest`` comes back from the points, times m_i."""
    start, slabs = grid.start, len(grid.start) - 2
    for colour in range(COLOURS):
        for part in prange(PARTS):
            for slab in part_of(start, slabs, part, colour, COLOURS):
                for q in range(start[slab], start[slab + 1]):
                    p: int = grid.order[q]
                    m: float = points.mass[p]
                    at = around(points, p, grid, shape)
                    back = sampled(rest, grid, at)
                    spread(seen, grid, at, m * back.x, m * back.y, m * back.z, m)


@kernel
def add_rest(grid: Grid, rest: Array, seen: Array) -> None:
    """Take what came back from the nodes' ``rest`` and add what is left to their velocity."""
    momentum, velocity = grid.momentum, grid.velocity
    for n in prange(len(momentum)):
        m = momentum[n, 3]
        per_mass = 1.0 / m if m > 0.0 else 0.0
        for a in range(3):
            rest[n, a] -= per_mass * seen[n, a]
            velocity[n, a] += rest[n, a]


@implements(give, Fmpm)
def momentum(transfer: Fmpm, points: Points, p: int, grid: Grid, at: Support) -> None:
    m, v = points.mass[p], points.velocity[p]
    spread(grid.momentum, grid, at, m * v[0], m * v[1], m * v[2], m)


@implements(give_with_force, Fmpm)
def momentum_and_force(transfer: Fmpm, points: Points, p: int, grid: Grid, at: Support, pull: Sym) -> None:
    m, v = points.mass[p], points.velocity[p]
    spread_with_force(grid, at, m * v[0], m * v[1], m * v[2], m, pull)


@implements(take, Fmpm)
def seen_velocity(transfer: Fmpm, points: Points, p: int, grid: Grid, at: Support) -> None:
    moves = sampled(grid.velocity, grid, at)
    carry(points, p, moves, moves)
