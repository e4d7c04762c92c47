"""Kernels that carry mass, momentum, force and motion between points and nodes, by one of ``mpm.transfers``."""

from typing import Any

from viscopoint.kernels.jit import PARTS, kernel
from viscopoint.kernels.slabs import COLOURS, chunk, coloured_slabs_of, slabs_of
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.stencil import stencil_at
from viscopoint.methods.mpm.transfers import g2p, p2g, p2g_with_force
from viscopoint.methods.mpm.volumes import acting_stress


@kernel(PARTS, COLOURS)
def scatter_momentum_and_force(part: int, points: Points, grid: Grid, shape: Any, volume: Any, transfer: Any) -> None:
    """Map m_i = Σ N m_p, (mv)_i = Σ N m_p v_p (and what else the transfer brings) and f_i = -Σ V_p σ_p ∇N."""
    start = grid.start
    for slab in coloured_slabs_of(start, len(start) - 2, part):
        for q in range(start[slab], start[slab + 1]):
            p: int = grid.order[q]
            at = stencil_at(points, p, grid, shape)
            stress = acting_stress(volume, points, p, grid)
            size = points.shared.jacobian[p] * points.volume[p]
            p2g_with_force(transfer, points, p, grid, at, (-size * grid.per_cell) * stress)


@kernel(PARTS, COLOURS)
def scatter_momentum(part: int, points: Points, grid: Grid, shape: Any, transfer: Any) -> None:
    """Map m_i = Σ N m_p and (mv)_i = Σ N m_p v_p, and what else the transfer brings."""
    start = grid.start
    for slab in coloured_slabs_of(start, len(start) - 2, part):
        for q in range(start[slab], start[slab + 1]):
            p: int = grid.order[q]
            p2g(transfer, points, p, grid, stencil_at(points, p, grid, shape))


@kernel()
def gather_velocity(part: int, points: Points, grid: Grid, shape: Any, transfer: Any) -> None:
    """Change the points' velocity by the nodes' motion."""
    start = grid.start
    for slab in slabs_of(start, len(start) - 2, part):
        for q in range(start[slab], start[slab + 1]):
            p: int = grid.order[q]
            g2p(transfer, points, p, grid, stencil_at(points, p, grid, shape))


@kernel(PARTS, COLOURS)
def gather_velocity_and_remap(part: int, points: Points, grid: Grid, shape: Any, transfer: Any) -> None:
    """Change the points' velocity by the nodes' motion, and map m_i and (mv)_i of the accelerated points back.

    Both in one visit to each point: the nodes' velocities are read, their momenta are written.
    """
    start = grid.start
    for slab in coloured_slabs_of(start, len(start) - 2, part):
        for q in range(start[slab], start[slab + 1]):
            p: int = grid.order[q]
            at = stencil_at(points, p, grid, shape)
            g2p(transfer, points, p, grid, at)
            p2g(transfer, points, p, grid, at)


@kernel()
def move(part: int, points: Points, grid: Grid, dt: float) -> None:
    """Move the points, x_p += Δt Σ N v_i."""
    for q in chunk(part, PARTS, grid.start[len(grid.start) - 2]):
        p: int = grid.order[q]
        for a in range(3):
            points.position[p, a] += dt * points.grid_velocity[p, a]
