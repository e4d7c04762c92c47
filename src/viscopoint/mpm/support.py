"""The nodes around a point: what kernels add to them and read from them."""

from typing import Any, NamedTuple

import numpy as np

from viscopoint.arrays import Array
from viscopoint.jit import inline
from viscopoint.mpm.grid import Grid
from viscopoint.mpm.points import Points
from viscopoint.mpm.shapes import Weights, along, stencil
from viscopoint.tensors import Matrix, Sym


class Support(NamedTuple):
    """The nodes around a point: row of the first, weights and slopes (per cell) along each axis."""

    first: int
    wx: Weights
    wy: Weights
    wz: Weights
    dx: Weights
    dy: Weights
    dz: Weights


@inline
def around(points: Points, p: int, grid: Grid, shape: Any) -> Support:
    """Return the nodes on which point p acts."""
    i, wx, dx = stencil(along(shape, points, p, 0), (points.position[p, 0] - grid.x0) * grid.per_cell)
    j, wy, dy = stencil(along(shape, points, p, 1), (points.position[p, 1] - grid.y0) * grid.per_cell)
    k, wz, dz = stencil(along(shape, points, p, 2), (points.position[p, 2] - grid.z0) * grid.per_cell)
    return Support((k * grid.ny + j) * grid.nx + i - grid.shift, wx, wy, wz, dx, dy, dz)


@inline
def cell_row(points: Points, p: int, grid: Grid) -> np.uint64:
    """Return the row of the cell that holds point p: that of its first node."""
    i = np.uint64((points.position[p, 0] - grid.x0) * grid.per_cell)
    j = np.uint64((points.position[p, 1] - grid.y0) * grid.per_cell)
    k = np.uint64((points.position[p, 2] - grid.z0) * grid.per_cell)
    return (k * grid.ny + j) * grid.nx + i - grid.shift


# Rows of nodes are addressed by unsigned integers: signed ones would be checked for counting from the end, which
# costs a third of the speed and keeps a row from moving as one vector.


@inline
def spread(field: Array, grid: Grid, at: Support, x: float, y: float, z: float, m: float) -> None:
    """Add N (x, y, z, m) to the nodes."""
    for c in range(len(at.wz)):
        for b in range(len(at.wy)):
            row = at.first + (np.uint64(c) * grid.ny + np.uint64(b)) * grid.nx
            for a in range(len(at.wx)):
                node = row + np.uint64(a)
                w = at.wx[a] * at.wy[b] * at.wz[c]
                field[node, 0] += w * x
                field[node, 1] += w * y
                field[node, 2] += w * z
                field[node, 3] += w * m


@inline
def spread_with_force(grid: Grid, at: Support, x: float, y: float, z: float, m: float, s: Sym) -> None:
    """Add N (x, y, z, m) to the nodes' momentum and s · ∇N (per cell) to their force, in one visit to each node."""
    momentum, force = grid.momentum, grid.change
    for c in range(len(at.wz)):
        for b in range(len(at.wy)):
            row = at.first + (np.uint64(c) * grid.ny + np.uint64(b)) * grid.nx
            for a in range(len(at.wx)):
                node = row + np.uint64(a)
                w = at.wx[a] * at.wy[b] * at.wz[c]
                momentum[node, 0] += w * x
                momentum[node, 1] += w * y
                momentum[node, 2] += w * z
                momentum[node, 3] += w * m
                gx = at.dx[a] * at.wy[b] * at.wz[c]
                gy = at.wx[a] * at.dy[b] * at.wz[c]
                gz = at.wx[a] * at.wy[b] * at.dz[c]
                force[node, 0] += s.xx * gx + s.xy * gy + s.zx * gz
                force[node, 1] += s.xy * gx + s.yy * gy + s.yz * gz
                force[node, 2] += s.zx * gx + s.yz * gy + s.zz * gz
                force[node, 3] += 0.0  # keeps the row one vector


@inline
def motion(grid: Grid, at: Support) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return Σ N v_i and Σ N Δv_i at a point, in one visit to each node."""
    velocity, change = grid.velocity, grid.change
    vx, vy, vz, ax, ay, az = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for c in range(len(at.wz)):
        for b in range(len(at.wy)):
            row = at.first + (np.uint64(c) * grid.ny + np.uint64(b)) * grid.nx
            for a in range(len(at.wx)):
                node = row + np.uint64(a)
                w = at.wx[a] * at.wy[b] * at.wz[c]
                vx += w * velocity[node, 0]
                vy += w * velocity[node, 1]
                vz += w * velocity[node, 2]
                ax += w * change[node, 0]
                ay += w * change[node, 1]
                az += w * change[node, 2]
    return (vx, vy, vz), (ax, ay, az)


@inline
def sampled(field: Array, grid: Grid, at: Support) -> tuple[float, float, float]:
    """Return Σ N field at a point."""
    x, y, z = 0.0, 0.0, 0.0
    for c in range(len(at.wz)):
        for b in range(len(at.wy)):
            row = at.first + (np.uint64(c) * grid.ny + np.uint64(b)) * grid.nx
            for a in range(len(at.wx)):
                node = row + np.uint64(a)
                w = at.wx[a] * at.wy[b] * at.wz[c]
                x += w * field[node, 0]
                y += w * field[node, 1]
                z += w * field[node, 2]
    return x, y, z


@inline
def gradient(field: Array, grid: Grid, at: Support, scale: float) -> Matrix:
    """Return ``scale`` Σ field ⊗ ∇N (per cell) at a point."""
    xx, xy, xz, yx, yy, yz, zx, zy, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for c in range(len(at.wz)):
        for b in range(len(at.wy)):
            row = at.first + (np.uint64(c) * grid.ny + np.uint64(b)) * grid.nx
            for a in range(len(at.wx)):
                node = row + np.uint64(a)
                gx = at.dx[a] * at.wy[b] * at.wz[c]
                gy = at.wx[a] * at.dy[b] * at.wz[c]
                gz = at.wx[a] * at.wy[b] * at.dz[c]
                x, y, z = field[node, 0], field[node, 1], field[node, 2]
                xx += x * gx
                xy += x * gy
                xz += x * gz
                yx += y * gx
                yy += y * gy
                yz += y * gz
                zx += z * gx
                zy += z * gy
                zz += z * gz
    return Matrix(
        scale * xx, scale * xy, scale * xz,
        scale * yx, scale * yy, scale * yz,
        scale * zx, scale * zy, scale * zz,
    )  # fmt: skip
