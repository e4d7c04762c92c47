"""The boundaries act on the nodes of the grid plane where they stand, and beyond it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from viscopoint.interactions.planes import TALLY, RigidWall, Symmetry, held
from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import serial_kernel
from viscopoint.methods.mpm.contacts import Contact, closed
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.shapes import NOWHERE, Planes


def plane_of(boundary: RigidWall | Symmetry, grid: Grid) -> tuple[int, float, int]:
    """Return axis and position [mm] of a boundary, and its plane of nodes, counted from the lattice's first."""
    axis, position = (2, boundary.height) if isinstance(boundary, RigidWall) else boundary
    return axis, position, round((position - (grid.x0, grid.y0, grid.z0)[axis]) * grid.per_cell)


def walls_around(
    boundaries: tuple[RigidWall | Symmetry, ...], grid: Grid, body_middle: tuple[float, ...]
) -> tuple[Planes, Planes, Planes]:
    """Return the planes of nodes between which the body is, along each axis."""
    planes = [[NOWHERE, NOWHERE] for _ in range(3)]
    for boundary in boundaries:
        axis, position, plane = plane_of(boundary, grid)
        planes[axis][int(position > body_middle[axis])] = plane
    (x0, x1), (y0, y1), (z0, z1) = planes
    return (x0, x1), (y0, y1), (z0, z1)


def touch(
    contact: Contact, boundary: RigidWall | Symmetry, grid: Grid, body_middle: tuple[float, float, float]
) -> Array:
    """Hold the nodes on a boundary's plane or beyond it; return impulse and work on the body (see ``TALLY``)."""
    axis, position, plane = plane_of(boundary, grid)
    plane -= (grid.i0, grid.j0, grid.k0)[axis]
    low, high = np.zeros(3, np.int64), np.array([grid.nx, grid.ny, grid.nz], np.int64)
    if position <= body_middle[axis]:
        high[axis] = min(max(plane + 1, 0), high[axis])
    else:
        low[axis] = min(max(plane, 0), high[axis])
    tally = np.zeros(TALLY)
    hold(contact, boundary, grid, low, high, tally)
    return tally


@serial_kernel
def hold(
    contact: Any, boundary: Any, grid: Grid, low: NDArray[np.int64], high: NDArray[np.int64], tally: Array
) -> None:
    """Apply a boundary to the velocity, and its change, of the nodes ``low`` to ``high`` of the window."""
    velocity, change = grid.velocity, grid.change
    for k in range(low[2], high[2]):
        for j in range(low[1], high[1]):
            for i in range(low[0], high[0]):
                n = (np.uint64(k) * grid.ny + np.uint64(j)) * grid.nx + np.uint64(i)
                m = grid.momentum[n, 3]
                if m > 0.0 and closed(contact, n):
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
