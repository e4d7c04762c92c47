"""Kernels that carry mass, momentum, force and motion between points and nodes."""

from typing import Any

from numba import prange

from viscopoint.jit import inline, kernel
from viscopoint.mpm.grid import Grid
from viscopoint.mpm.points import Points
from viscopoint.mpm.support import Support, around, motion, spread, spread_with_force
from viscopoint.mpm.volumes import pull


@kernel
def scatter_momentum_and_force(points: Points, grid: Grid, shape: Any, volume: Any) -> None:
    """Map m_i = Σ N m_p, (mv)_i = Σ N m_p v_p and f_i = -Σ V_p σ_p ∇N."""
    slabs = len(grid.start) - 2
    for colour in range(2):
        for pair in prange((slabs - colour + 1) // 2):
            slab = 2 * pair + colour
            for q in range(grid.start[slab], grid.start[slab + 1]):
                p: int = grid.order[q]
                at = around(points, p, grid, shape)
                m: float = points.mass[p]
                v = points.velocity[p]
                stress = pull(volume, points, p, grid)
                size = points.jacobian[p] * points.volume[p]
                spread_with_force(grid, at, m * v[0], m * v[1], m * v[2], m, (-size * grid.per_cell) * stress)


@kernel
def scatter_momentum(points: Points, grid: Grid, shape: Any) -> None:
    """Map m_i = Σ N m_p and (mv)_i = Σ N m_p v_p."""
    slabs = len(grid.start) - 2
    for colour in range(2):
        for pair in prange((slabs - colour + 1) // 2):
            slab = 2 * pair + colour
            for q in range(grid.start[slab], grid.start[slab + 1]):
                p: int = grid.order[q]
                m: float = points.mass[p]
                v = points.velocity[p]
                spread(grid.momentum, grid, around(points, p, grid, shape), m * v[0], m * v[1], m * v[2], m)


@inline
def accelerated(points: Points, p: int, grid: Grid, at: Support, pic: float) -> tuple[float, float, float]:
    """Return v_p + Σ N Δv_i (FLIP), or by the share ``pic`` Σ N v_i, and note Σ N v_i, at which the point will move."""
    moves, gains = motion(grid, at)
    v = points.velocity[p]
    vx = (1.0 - pic) * (v[0] + gains[0]) + pic * moves[0]
    vy = (1.0 - pic) * (v[1] + gains[1]) + pic * moves[1]
    vz = (1.0 - pic) * (v[2] + gains[2]) + pic * moves[2]
    points.velocity[p, 0], points.velocity[p, 1], points.velocity[p, 2] = vx, vy, vz
    points.drift[p, 0], points.drift[p, 1], points.drift[p, 2] = moves[0], moves[1], moves[2]
    return vx, vy, vz


@kernel
def gather_velocity(points: Points, grid: Grid, shape: Any, pic: float) -> None:
    """Change the points' velocity by what the nodes gained."""
    for slab in prange(len(grid.start) - 2):
        for q in range(grid.start[slab], grid.start[slab + 1]):
            p: int = grid.order[q]
            accelerated(points, p, grid, around(points, p, grid, shape), pic)


@kernel
def gather_velocity_and_remap(points: Points, grid: Grid, shape: Any, pic: float) -> None:
    """Change the points' velocity by what the nodes gained, and map m_i and (mv)_i of the accelerated points back.

    Both in one visit to each point: the nodes' velocities are read, their momenta are written.
    """
    slabs = len(grid.start) - 2
    for colour in range(2):
        for pair in prange((slabs - colour + 1) // 2):
            slab = 2 * pair + colour
            for q in range(grid.start[slab], grid.start[slab + 1]):
                p: int = grid.order[q]
                at = around(points, p, grid, shape)
                vx, vy, vz = accelerated(points, p, grid, at, pic)
                m: float = points.mass[p]
                spread(grid.momentum, grid, at, m * vx, m * vy, m * vz, m)


@kernel
def move(points: Points, grid: Grid, dt: float) -> None:
    """Move the points, x_p += Δt Σ N v_i."""
    position = points.position
    for q in prange(grid.start[len(grid.start) - 2]):
        p = grid.order[q]
        for a in range(3):
            position[p, a] += dt * points.drift[p, a]
