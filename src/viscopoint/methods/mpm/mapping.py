"""Kernels that carry mass, momentum, force and motion between points and nodes, by one of ``mpm.transfers``."""

from typing import Any

from numba import prange

from viscopoint.kernels.jit import kernel
from viscopoint.kernels.slabs import COLOURS, PARTS, part_of
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.support import around
from viscopoint.methods.mpm.transfers import give, give_with_force, take
from viscopoint.methods.mpm.volumes import pull


@kernel
def scatter_momentum_and_force(points: Points, grid: Grid, shape: Any, volume: Any, transfer: Any) -> None:
    """Map m_i = Σ N m_p, (mv)_i = Σ N m_p v_p (and what else the transfer brings) and f_i = -Σ V_p σ_p ∇N."""
    start, slabs = grid.start, len(grid.start) - 2
    for colour in range(COLOURS):
        for part in prange(PARTS):
            for slab in part_of(start, slabs, part, colour, COLOURS):
                for q in range(start[slab], start[slab + 1]):
                    p: int = grid.order[q]
                    at = around(points, p, grid, shape)
                    stress = pull(volume, points, p, grid)
                    size = points.jacobian[p] * points.volume[p]
                    give_with_force(transfer, points, p, grid, at, (-size * grid.per_cell) * stress)


@kernel
def scatter_momentum(points: Points, grid: Grid, shape: Any, transfer: Any) -> None:
    """Map m_i = Σ N m_p and (mv)_i = Σ N m_p v_p, and what else the transfer brings."""
    start, slabs = grid.start, len(grid.start) - 2
    for colour in range(COLOURS):
        for part in prange(PARTS):
            for slab in part_of(start, slabs, part, colour, COLOURS):
                for q in range(start[slab], start[slab + 1]):
                    p: int = grid.order[q]
                    give(transfer, points, p, grid, around(points, p, grid, shape))


@kernel
def gather_velocity(points: Points, grid: Grid, shape: Any, transfer: Any) -> None:
    """Change the points' velocity by the nodes' motion."""
    start, slabs = grid.start, len(grid.start) - 2
    for part in prange(PARTS):
        for slab in part_of(start, slabs, part):
            for q in range(start[slab], start[slab + 1]):
                p: int = grid.order[q]
                take(transfer, points, p, grid, around(points, p, grid, shape))


@kernel
def gather_velocity_and_remap(points: Points, grid: Grid, shape: Any, transfer: Any) -> None:
    """Change the points' velocity by the nodes' motion, and map m_i and (mv)_i of the accelerated points back.

    Both in one visit to each point: the nodes' velocities are read, their momenta are written.
    """
    start, slabs = grid.start, len(grid.start) - 2
    for colour in range(COLOURS):
        for part in prange(PARTS):
            for slab in part_of(start, slabs, part, colour, COLOURS):
                for q in range(start[slab], start[slab + 1]):
                    p: int = grid.order[q]
                    at = around(points, p, grid, shape)
                    take(transfer, points, p, grid, at)
                    give(transfer, points, p, grid, at)


@kernel
def move(points: Points, grid: Grid, dt: float) -> None:
    """Move the points, x_p += Δt Σ N v_i."""
    position = points.position
    for q in prange(grid.start[len(grid.start) - 2]):
        p = grid.order[q]
        for a in range(3):
            position[p, a] += dt * points.drift[p, a]
