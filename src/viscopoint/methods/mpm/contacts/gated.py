"""Nodes of the wall's plane are held while material that has arrived at the wall acts on them.

A point's material ends half its height below it. That height stretches with the point, so that

    z_p - lambda_z height / 2 <= wall

says that it has arrived. Between a held plane of nodes and the first one above it the velocity is v_1 z / h, and both
sides shrink at the rate v_1 / h: what has arrived stays on the wall, without drift, until the nodes move off it. When
the gate closes, points stand half a height above the wall's nodes (less what they flew since they arrived, up to a
step), whatever the gap was: from there on, runs with different gaps are alike.
"""

from typing import Any, NamedTuple

import numpy as np

from viscopoint.interactions.planes import RigidWall
from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import implements, inline, serial_kernel
from viscopoint.methods.mpm.contacts import closed, offer
from viscopoint.methods.mpm.grid import Grid, forget
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.support import Support, around

TOUCHING = 1e-9  # cells; a foot that stands on the wall does so whatever the last bit of its height
REACH = 2  # cells; points further above the wall act on none of its nodes


@offer("gated")
class Gated(NamedTuple):
    """The nodes on which arrived material acts."""

    arrived: Array  # [n, 4], the first not 0

    stretches = True
    spares = 1

    @classmethod
    def at(cls, wall: RigidWall, points: Points, grid: Grid, shape: Any, half: float) -> "Gated":
        arrived = grid.spare[0]
        forget(arrived)
        mark_arrived(points, grid, shape, wall.height, half, arrived)
        return cls(arrived)


@serial_kernel
def mark_arrived(points: Points, grid: Grid, shape: Any, height: float, half: float, arrived: Array) -> None:
    """Mark the nodes on which a point acts whose lower edge is at the wall or below."""
    near = int((height - grid.z0) * grid.per_cell) + REACH  # few points: only slabs that begin below this plane
    for slab in range(min(near // grid.layers + 1, len(grid.start) - 2)):
        for q in range(grid.start[slab], grid.start[slab + 1]):
            p = grid.order[q]
            if points.position[p, 2] - half * points.stretch[p, 2] <= height + TOUCHING * grid.cell:
                mark(arrived, grid, around(points, p, grid, shape))


@inline
def mark(field: Array, grid: Grid, at: Support) -> None:
    """Mark the nodes on which a point acts."""
    for c in range(len(at.wz)):
        for b in range(len(at.wy)):
            row = at.first + (np.uint64(c) * grid.ny + np.uint64(b)) * grid.nx
            for a in range(len(at.wx)):
                if at.wx[a] * at.wy[b] * at.wz[c] > 0.0:
                    field[row + np.uint64(a), 0] = 1.0


@implements(closed, Gated)
def where_arrived(contact: Gated, node: np.uint64) -> bool:
    return contact.arrived[node, 0] != 0.0
