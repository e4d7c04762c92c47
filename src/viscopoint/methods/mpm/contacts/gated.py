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

from viscopoint.interactions.planes import Plane
from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import implements, inline, serial_kernel
from viscopoint.kernels.vectors import dot, inner, read_vector
from viscopoint.methods.mpm.contacts import CONTACTS, closed
from viscopoint.methods.mpm.grid import Grid, zero
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.stencil import Stencil, stencil_at

TOUCHING = 1e-9  # cells; a foot that stands on the wall does so whatever the last bit of its height
SUPPORT = 2  # cells; points further above the wall act on none of its nodes


@CONTACTS.register("gated")
class Gated(NamedTuple):
    """The nodes on which arrived material acts."""

    arrived: Array  # [n, 4], the first not 0

    stretches = True
    spares = 1

    @classmethod
    def at(cls, wall: Plane, points: Points, grid: Grid, shape: Any, half: float) -> "Gated":
        arrived = grid.spare[0]
        zero(arrived)
        slabs = len(grid.start) - 2
        if wall.normal[2] == 1.0:  # few points: only slabs that begin below this plane
            slabs = min(max(int((wall.point[2] - grid.z0) * grid.per_cell) + SUPPORT, 0) // grid.layers + 1, slabs)
        mark_arrived(points, grid, shape, wall, half, slabs, arrived)
        return cls(arrived)


@serial_kernel
def mark_arrived(points: Points, grid: Grid, shape: Any, wall: Plane, half: float, slabs: int, arrived: Array) -> None:
    """Mark the nodes on which a point acts whose box reaches the wall."""
    n, point = read_vector(wall.normal), read_vector(wall.point)
    for slab in range(slabs):
        for q in range(grid.start[slab], grid.start[slab + 1]):
            p = grid.order[q]
            extent = half * inner(
                abs(n.x), points.stretch[p, 0], abs(n.y), points.stretch[p, 1], abs(n.z), points.stretch[p, 2]
            )
            if dot(read_vector(points.position[p]) - point, n) - extent <= TOUCHING * grid.cell:
                mark(arrived, grid, stencil_at(points, p, grid, shape))


@inline
def mark(field: Array, grid: Grid, at: Stencil) -> None:
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
