"""The boundaries act on the nodes of the grid plane where they stand, and beyond it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from viscopoint.arrays import Array
from viscopoint.jit import serial_kernel
from viscopoint.mpm.grid import Grid
from viscopoint.wall import TALLY, RigidWall, Symmetry, held


def touch(boundary: RigidWall | Symmetry, grid: Grid, body_middle: tuple[float, float, float]) -> Array:
    """Hold the nodes on a boundary's plane or beyond it; return impulse and work on the body (see ``TALLY``)."""
    axis, position = (2, boundary.height) if isinstance(boundary, RigidWall) else boundary
    plane = round((position - (grid.x0, grid.y0, grid.z0)[axis]) * grid.per_cell) - (grid.i0, grid.j0, grid.k0)[axis]
    low, high = np.zeros(3, np.int64), np.array([grid.nx, grid.ny, grid.nz], np.int64)
    if position <= body_middle[axis]:
        high[axis] = min(max(plane + 1, 0), high[axis])
    else:
        low[axis] = min(max(plane, 0), high[axis])
    tally = np.zeros(TALLY)
    hold(boundary, grid, low, high, tally)
    return tally


@serial_kernel
def hold(boundary: Any, grid: Grid, low: NDArray[np.int64], high: NDArray[np.int64], tally: Array) -> None:
    """Apply a boundary to the velocity, and its change, of the nodes ``low`` to ``high`` of the window."""
    velocity, change = grid.velocity, grid.change
    for k in range(low[2], high[2]):
        for j in range(low[1], high[1]):
            for i in range(low[0], high[0]):
                n = (np.uint64(k) * grid.ny + np.uint64(j)) * grid.nx + np.uint64(i)
                m = grid.momentum[n, 3]
                if m > 0.0:
                    ux, uy, uz = velocity[n, 0], velocity[n, 1], velocity[n, 2]
                    vx, vy, vz = held(boundary, ux, uy, uz)
                    dx, dy, dz = vx - ux, vy - uy, vz - uz
                    velocity[n, 0], velocity[n, 1], velocity[n, 2] = vx, vy, vz
                    change[n, 0] += dx
                    change[n, 1] += dy
                    change[n, 2] += dz
                    tally[0] += m * dx
                    tally[1] += m * dy
                    tally[2] += m * dz
                    x0, y0, z0 = grid.momentum[n, 0] / m, grid.momentum[n, 1] / m, grid.momentum[n, 2] / m
                    tally[3] += 0.5 * m * (vz * vz - z0 * z0) if dz != 0.0 else 0.0
                    tally[4] += 0.5 * m * (dx * (vx + x0) + dy * (vy + y0))
