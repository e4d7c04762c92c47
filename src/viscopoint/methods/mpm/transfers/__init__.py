"""Transfers between points and nodes (P2G, G2P): one short file each, found by itself.

A transfer is a NamedTuple (of its parameters, if it has any), registered under the name that a case uses, and
implementations of ``p2g``, ``p2g_with_force`` and ``g2p``. In all of them the points move with Σ N v_i, the velocity
of the accelerated nodes, and linear momentum goes over without loss. They differ in what a point stores:

- of velocities that the nodes do not see: FLIP keeps them, and with them the noise; the others damp them;
- of the motion around the point: FLIP and PIC nothing, APIC a moment, TPIC a gradient.

A wave of which points and nodes leave each other the share F per exchange, S⁺S v = F v (S interpolates to the points by
N, S⁺ averages back), loses nothing by FLIP, 1 - F each step by PIC, and what no affine field around the points can hold
by APIC and TPIC: part of the energy error. The motion that APIC and TPIC keep around points goes back to the nodes;
it is kinetic energy of the points, m_p (v_p² + tr(C D C^T)) / 2 with C = B D⁻¹ for APIC, when they took it.
"""

from typing import Any, Protocol, Self

from viscopoint.discovery import Registry, import_all
from viscopoint.kernels.jit import generic, inline
from viscopoint.kernels.tensors import Sym
from viscopoint.kernels.vectors import Float4
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.stencil import Stencil


class Transfer(Protocol):
    """What the method asks of a transfer beside ``p2g``, ``p2g_with_force`` and ``g2p``."""

    @classmethod
    def chosen(cls, pic: float) -> Self:
        """Return the transfer with the share of PIC, if it has such."""
        ...

    @property
    def affine(self) -> bool:
        """Whether each point needs memory for a general tensor."""
        ...

    @property
    def dissipates(self) -> str:
        """By what the transfer loses energy, in the words of the guard that stops a run for it."""
        ...


TRANSFERS: Registry[type[Transfer]] = Registry()


@generic
def p2g(transfer: Any, points: Points, p: int, grid: Grid, at: Stencil) -> None:
    """Add mass and momentum of point p to the nodes around it, for the velocity by which points are strained."""
    raise NotImplementedError


@generic
def p2g_with_force(transfer: Any, points: Points, p: int, grid: Grid, at: Stencil, pull: Sym) -> None:
    """Add mass and momentum of point p, and the force ``pull`` · ∇N (per cell) [N], in one visit to each node."""
    raise NotImplementedError


@generic
def g2p(transfer: Any, points: Points, p: int, grid: Grid, at: Stencil) -> None:
    """Let point p have its new velocity, and note Σ N v_i, at which it will move."""
    raise NotImplementedError


@inline
def store_velocity(points: Points, p: int, velocity: Float4, grid_velocity: Float4) -> None:
    """Store a point's velocity and the one with which it moves."""
    points.velocity[p, 0], points.velocity[p, 1], points.velocity[p, 2] = velocity.x, velocity.y, velocity.z
    moves = points.grid_velocity[p]
    moves[0], moves[1], moves[2] = grid_velocity.x, grid_velocity.y, grid_velocity.z


import_all(__name__)
