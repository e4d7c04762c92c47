"""The nodes around a point: what kernels add to them and read from them."""

from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import generic, implements, inline
from viscopoint.kernels.tensors import Matrix, Sym
from viscopoint.kernels.values import fma, pick
from viscopoint.kernels.vectors import Float4, fetch, put, zeros4
from viscopoint.methods.mpm.grid import Grid, HalfPlane
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.shapes import Weights, along, stencil


class Stencil(NamedTuple):
    """The nodes around a point: row of the first, weights and slopes (per cell) along each axis."""

    first: int
    wx: Weights
    wy: Weights
    wz: Weights
    dx: Weights
    dy: Weights
    dz: Weights
    per_radius: float  # 1/r of a ring, per cell; in space 0


class Ring(Stencil):
    """The same around a ring: nodes of the half plane, one along y."""


@generic
def stencil_around(grid: Any, shift: Any, shapes: Any, place: tuple[float, float, float], radius: float) -> Any:
    """Return the nodes around a place, a ``Stencil`` or a ``Ring``.

    Args:
        grid: how many nodes there are along x and y, and, by its class, whether they are rings.
        shift: takes a row counted from the grid's first node to where it is in memory.
        shapes: the shape function along x, y and z.
        place: x, y and z in cells from the grid's first node.
        radius: distance from the axis, in cells.
    """
    raise NotImplementedError


@implements(stencil_around, Grid)
def in_space(grid: Any, shift: Any, shapes: Any, place: tuple[float, float, float], radius: float) -> Stencil:
    i, wx, dx = stencil(shapes[0], place[0])
    j, wy, dy = stencil(shapes[1], place[1])
    k, wz, dz = stencil(shapes[2], place[2])
    return Stencil((k * grid.ny + j) * grid.nx + i - shift, wx, wy, wz, dx, dy, dz, 0.0)


@implements(stencil_around, HalfPlane)
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
def stencil_at(points: Points, p: int, grid: Grid, shape: Any) -> Any:
    """Return the nodes on which point p acts."""
    x = (points.position[p, 0] - grid.x0) * grid.per_cell
    y = (points.position[p, 1] - grid.y0) * grid.per_cell
    z = (points.position[p, 2] - grid.z0) * grid.per_cell
    shapes = along(shape, points, p, 0), along(shape, points, p, 1), along(shape, points, p, 2)
    return stencil_around(grid, grid.shift, shapes, (x, y, z), points.position[p, 0] * grid.per_cell)


@inline
def cell_row(points: Points, p: int, grid: Grid) -> np.uint64:
    """Return the row of the cell that holds point p: that of its first node."""
    i = np.uint64((points.position[p, 0] - grid.x0) * grid.per_cell)
    j = np.uint64((points.position[p, 1] - grid.y0) * grid.per_cell)
    k = np.uint64((points.position[p, 2] - grid.z0) * grid.per_cell)
    return (k * grid.ny + j) * grid.nx + i - grid.shift


# Rows of nodes are addressed by unsigned integers (signed ones would be checked for counting from the end) and move as
# one vector. Sums go axis by axis: what nodes along x share is multiplied once. Against a weight formed for each node,
# trilinear kernels take half the time, quadratic ones a quarter.


@inline
def node_row(grid: Any, at: Any, b: int, c: int) -> np.uint64:
    """Return the row of the first node along x of those b-th along y and c-th along z."""
    return at.first + (np.uint64(c) * grid.ny + np.uint64(b)) * grid.nx


@inline
def scatter(field: Array, grid: Any, at: Any, x: float, y: float, z: float, m: float) -> None:
    """Add N (x, y, z, m) to the nodes."""
    value = Float4(x, y, z, m)
    for c in range(len(at.wz)):
        layer = pick(at.wz, c) * value
        for b in range(len(at.wy)):
            line, row = pick(at.wy, b) * layer, node_row(grid, at, b, c)
            for a in range(len(at.wx)):
                node = row + np.uint64(a)
                put(field, node, fma(pick(at.wx, a), line, fetch(field, node)))


@inline
def scatter_with_force(grid: Grid, at: Any, x: float, y: float, z: float, m: float, s: Sym) -> None:
    """Add N (x, y, z, m) to the nodes' momentum and s · ∇N (per cell) to their force, in one visit to each node."""
    momentum, force, value = grid.momentum, grid.force, Float4(x, y, z, m)
    sx, sy, sz = Float4(s.xx, s.xy, s.zx, 0.0), Float4(s.xy, s.yy, s.yz, 0.0), Float4(s.zx, s.yz, s.zz, 0.0)
    for c in range(len(at.wz)):
        wz, dz = pick(at.wz, c), pick(at.dz, c)
        layer, along_x, along_y, along_z = wz * value, wz * sx, wz * sy, dz * sz
        for b in range(len(at.wy)):
            wy, dy, row = pick(at.wy, b), pick(at.dy, b), node_row(grid, at, b, c)
            line, slope, rest = wy * layer, wy * along_x, fma(wy, along_z, dy * along_y)
            for a in range(len(at.wx)):
                node, wx, dx = row + np.uint64(a), pick(at.wx, a), pick(at.dx, a)
                put(momentum, node, fma(wx, line, fetch(momentum, node)))
                put(force, node, fma(wx, rest, fma(dx, slope, fetch(force, node))))
    scatter_hoop_force(at, force, grid, s.yy)


@inline
def scatter_gradient(field: Array, grid: Any, at: Any, x: Float4, y: Float4, z: Float4) -> None:
    """Add x ∂N/∂x + y ∂N/∂y + z ∂N/∂z (per cell) to the nodes."""
    for c in range(len(at.wz)):
        wz, dz = pick(at.wz, c), pick(at.dz, c)
        along_x, along_y, along_z = wz * x, wz * y, dz * z
        for b in range(len(at.wy)):
            wy, dy, row = pick(at.wy, b), pick(at.dy, b), node_row(grid, at, b, c)
            slope, rest = wy * along_x, fma(wy, along_z, dy * along_y)
            for a in range(len(at.wx)):
                node, wx, dx = row + np.uint64(a), pick(at.wx, a), pick(at.dx, a)
                put(field, node, fma(wx, rest, fma(dx, slope, fetch(field, node))))


@inline
def interpolate(field: Array, grid: Any, at: Any) -> Float4:
    """Return Σ N field at a point."""
    mean = zeros4()
    for c in range(len(at.wz)):
        layer = zeros4()
        for b in range(len(at.wy)):
            line, row = zeros4(), node_row(grid, at, b, c)
            for a in range(len(at.wx)):
                line = fma(pick(at.wx, a), fetch(field, row + np.uint64(a)), line)
            layer = fma(pick(at.wy, b), line, layer)
        mean = fma(pick(at.wz, c), layer, mean)
    return mean


@inline
def interpolate_with_gradient(field: Array, grid: Any, at: Any) -> tuple[Float4, Float4, Float4, Float4]:
    """Return Σ N field and Σ field ∂N/∂x, /∂y and /∂z (per cell) at a point."""
    mean = along_x = along_y = along_z = zeros4()
    for c in range(len(at.wz)):
        wz, dz = pick(at.wz, c), pick(at.dz, c)
        layer = layer_x = layer_y = zeros4()
        for b in range(len(at.wy)):
            wy, dy, row = pick(at.wy, b), pick(at.dy, b), node_row(grid, at, b, c)
            line = line_x = zeros4()
            for a in range(len(at.wx)):
                value = fetch(field, row + np.uint64(a))
                line, line_x = fma(pick(at.wx, a), value, line), fma(pick(at.dx, a), value, line_x)
            layer, layer_x, layer_y = fma(wy, line, layer), fma(wy, line_x, layer_x), fma(dy, line, layer_y)
        mean, along_x = fma(wz, layer, mean), fma(wz, layer_x, along_x)
        along_y, along_z = fma(wz, layer_y, along_y), fma(dz, layer, along_z)
    return mean, along_x, along_y, along_z


@inline
def interpolate_motion(grid: Grid, at: Any) -> tuple[Float4, Float4]:
    """Return Σ N v_i and Σ N Δv_i at a point, in one visit to each node."""
    velocity, dv = grid.velocity, grid.dv
    moves = gains = zeros4()
    for c in range(len(at.wz)):
        layer = layer_gains = zeros4()
        for b in range(len(at.wy)):
            line = line_gains = zeros4()
            wy, row = pick(at.wy, b), node_row(grid, at, b, c)
            for a in range(len(at.wx)):
                node, wx = row + np.uint64(a), pick(at.wx, a)
                line, line_gains = fma(wx, fetch(velocity, node), line), fma(wx, fetch(dv, node), line_gains)
            layer, layer_gains = fma(wy, line, layer), fma(wy, line_gains, layer_gains)
        wz = pick(at.wz, c)
        moves, gains = fma(wz, layer, moves), fma(wz, layer_gains, gains)
    return moves, gains


@inline
def gradient(field: Array, grid: Any, at: Any, scale: float) -> Matrix:
    """Return ``scale`` Σ field ⊗ ∇N (per cell) at a point."""
    mean, x, y, z = interpolate_with_gradient(field, grid, at)
    return with_hoop_strain(at, mean, scale, Matrix(
        scale * x.x, scale * y.x, scale * z.x,
        scale * x.y, scale * y.y, scale * z.y,
        scale * x.z, scale * y.z, scale * z.z,
    ))  # fmt: skip


@generic
def with_hoop_strain(at: Any, mean: Float4, scale: float, a: Matrix) -> Matrix:
    """Return the gradient ``a`` with what moving away from the axis adds, ``scale`` Σ field_r N / r (per cell)."""
    raise NotImplementedError


@implements(with_hoop_strain, Stencil)
def as_it_is(at: Stencil, mean: Float4, scale: float, a: Matrix) -> Matrix:
    return a


@implements(with_hoop_strain, Ring)
def with_hoop(at: Ring, mean: Float4, scale: float, a: Matrix) -> Matrix:
    return Matrix(a.xx, a.xy, a.xz, a.yx, scale * at.per_radius * mean.x, a.yz, a.zx, a.zy, a.zz)


@generic
def scatter_hoop_force(at: Any, force: Array, grid: Any, hoop: float) -> None:
    """Add what a ring's stress around the axis pulls towards it, ``hoop`` N / r (per cell), to the nodes' force."""
    raise NotImplementedError


@implements(scatter_hoop_force, Stencil)
def not_at_all(at: Stencil, force: Array, grid: Any, hoop: float) -> None:
    pass


@implements(scatter_hoop_force, Ring)
def by_hoop(at: Any, force: Array, grid: Any, hoop: float) -> None:
    scatter(force, grid, at, hoop * at.per_radius, 0.0, 0.0, 0.0)
