"""FLIP, with any share of PIC (Brackbill & Ruppel 1986; Zhang, Chen & Liu 2016, ch. 3): the paper's.

    v_p += Σ N Δv_i,    or by the share ``pic``    v_p = Σ N v_i

FLIP keeps all that a point had and adds what the nodes gained. Angular momentum changes in each step by what nodes and
points know differently: -Σ m_p ε:Σ N Δv_i ⊗ (x_i - x_p), and as points move with Σ N v_i and not with v_p. PIC loses
Σ m_p ε:Σ N v_i ⊗ (x_i - x_p).
"""

from typing import NamedTuple

from viscopoint.kernels.jit import implements
from viscopoint.kernels.tensors import Sym
from viscopoint.kernels.vectors import Float4
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.stencil import Stencil, interpolate_motion, scatter, scatter_with_force
from viscopoint.methods.mpm.transfers import TRANSFERS, g2p, p2g, p2g_with_force, store_velocity


@TRANSFERS.register("flip")
class Flip(NamedTuple):
    """What the nodes gain is added to what the points have."""

    pic: float  # share of PIC, 0 to 1

    affine = False
    dissipates = "the transfers dissipate (method.pic_fraction)"

    @classmethod
    def chosen(cls, pic: float) -> "Flip":
        return cls(pic)


@implements(p2g, Flip)
def momentum(transfer: Flip, points: Points, p: int, grid: Grid, at: Stencil) -> None:
    m, v = points.mass[p], points.velocity[p]
    scatter(grid.momentum, grid, at, m * v[0], m * v[1], m * v[2], m)


@implements(p2g_with_force, Flip)
def momentum_and_force(transfer: Flip, points: Points, p: int, grid: Grid, at: Stencil, pull: Sym) -> None:
    m, v = points.mass[p], points.velocity[p]
    scatter_with_force(grid, at, m * v[0], m * v[1], m * v[2], m, pull)


@implements(g2p, Flip)
def gained(transfer: Flip, points: Points, p: int, grid: Grid, at: Stencil) -> None:
    moves, gains = interpolate_motion(grid, at)
    v, pic = points.velocity[p], transfer.pic
    store_velocity(points, p, (1.0 - pic) * (Float4(v[0], v[1], v[2], 0.0) + gains) + pic * moves, moves)
