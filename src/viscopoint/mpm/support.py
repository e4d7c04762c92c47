"""The nodes around a point: what kernels add to them and read from them."""

from typing import Any, NamedTuple

import numpy as np

from viscopoint.arrays import Array
from viscopoint.jit import generic, implements, inline
from viscopoint.mpm.grid import Grid, HalfPlane
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


class Ring(NamedTuple):
    """The same around a ring: nodes of the half plane, one along y."""

    first: int
    wx: Weights
    wy: Weights
    wz: Weights
    dx: Weights
    dy: Weights
    dz: Weights
    per_radius: float  # 1/r, per cell


@generic
def placed(grid: Any, shift: Any, shapes: Any, place: tuple[float, float, float], radius: float) -> Any:
    """Return the nodes around a place, a ``Support`` or a ``Ring``.

    Args:
        grid: how many nodes there are along x and y, and, by its class, whether they are rings.
        shift: takes a row counted from the grid's first node to where it is in memory.
        shapes: the shape function along x, y and z.
        place: x, y and z in cells from the grid's first node.
        radius: distance from the axis, in cells.
    """
    raise NotImplementedError


@implements(placed, Grid)
def in_space(grid: Any, shift: Any, shapes: Any, place: tuple[float, float, float], radius: float) -> Support:
    i, wx, dx = stencil(shapes[0], place[0])
    j, wy, dy = stencil(shapes[1], place[1])
    k, wz, dz = stencil(shapes[2], place[2])
    return Support((k * grid.ny + j) * grid.nx + i - shift, wx, wy, wz, dx, dy, dz)


@implements(placed, HalfPlane)
def in_half_plane(grid: Any, shift: Any, shapes: Any, place: tuple[float, float, float], radius: float) -> Ring:
    i, wx, dx = stencil(shapes[0], place[0])
    k, wz, dz = stencil(shapes[2], place[2])
    if i + 0.5 < place[0] - radius:  # beyond the axis
        wx, dx = continued(wx), continued(dx)
    return Ring(k * grid.nx + i - shift, wx, (1.0,), wz, dx, (0.0,), dz, 1.0 / radius)


@inline
def continued(weights: Weights) -> Weights:
    """Return weights or slopes without the first node, which moves as the next two say: v_-1 = 2 v_0 - v_1."""
    if len(weights) > 2:
        return (0.0, weights[1] + 2.0 * weights[0], weights[2] - weights[0]) + weights[3:]
    return weights  # trilinear ones reach no farther than the axis


@inline
def around(points: Points, p: int, grid: Grid, shape: Any) -> Any:
    """Return the nodes on which point p acts."""
    x = (points.position[p, 0] - grid.x0) * grid.per_cell
    y = (points.position[p, 1] - grid.y0) * grid.per_cell
    z = (points.position[p, 2] - grid.z0) * grid.per_cell
    shapes = along(shape, points, p, 0), along(shape, points, p, 1), along(shape, points, p, 2)
    return placed(grid, grid.shift, shapes, (x, y, z), points.position[p, 0] * grid.per_cell)


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
def spread(field: Array, grid: Any, at: Support, x: float, y: float, z: float, m: float) -> None:
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
    pull_in(at, force, grid, s.yy)


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
def sampled(field: Array, grid: Any, at: Support) -> tuple[float, float, float]:
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
    return widened(at, field, grid, scale, Matrix(
        scale * xx, scale * xy, scale * xz,
        scale * yx, scale * yy, scale * yz,
        scale * zx, scale * zy, scale * zz,
    ))  # fmt: skip


@generic
def widened(at: Any, field: Array, grid: Any, scale: float, a: Matrix) -> Matrix:
    """Return the gradient ``a`` with what moving away from the axis adds, ``scale`` Σ field_r N / r (per cell)."""
    raise NotImplementedError


@implements(widened, Support)
def as_it_is(at: Support, field: Array, grid: Any, scale: float, a: Matrix) -> Matrix:
    return a


@implements(widened, Ring)
def with_hoop(at: Any, field: Array, grid: Any, scale: float, a: Matrix) -> Matrix:
    x, _, _ = sampled(field, grid, at)
    return Matrix(a.xx, a.xy, a.xz, a.yx, scale * at.per_radius * x, a.yz, a.zx, a.zy, a.zz)


@generic
def pull_in(at: Any, force: Array, grid: Any, hoop: float) -> None:
    """Add what a ring's stress around the axis pulls towards it, ``hoop`` N / r (per cell), to the nodes' force."""
    raise NotImplementedError


@implements(pull_in, Support)
def not_at_all(at: Support, force: Array, grid: Any, hoop: float) -> None:
    pass


@implements(pull_in, Ring)
def by_hoop(at: Any, force: Array, grid: Any, hoop: float) -> None:
    spread(force, grid, at, hoop * at.per_radius, 0.0, 0.0, 0.0)
