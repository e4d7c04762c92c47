"""Points that carry a velocity gradient: what they give to the nodes around them, v_p + C (x_i - x_p)."""

import numpy as np

from viscopoint.arrays import Array
from viscopoint.jit import inline
from viscopoint.mpm.grid import Grid
from viscopoint.mpm.shapes import Weights
from viscopoint.mpm.support import Support, pull_in
from viscopoint.tensors import Matrix, Sym


@inline
def middle(weights: Weights) -> float:
    """Return Σ N i, the place of a point in cells from its first node.

    By the weights, which are true to themselves even where ``stencil`` keeps one from being zero.
    """
    place = 0.0
    for a in range(len(weights)):
        place += weights[a] * a
    return place


@inline
def inertia(weights: Weights) -> float:
    """Return D = Σ N (x_i - x_p)² along one axis, in cells². The three axes do not mix: Σ N (x_i - x_p) = 0."""
    if len(weights) == 1:
        return 1.0  # nothing varies along this axis: any but 0
    place, sum_of_squares = middle(weights), 0.0
    for a in range(len(weights)):
        sum_of_squares += weights[a] * (a - place) * (a - place)
    return sum_of_squares


@inline
def moment(field: Array, grid: Grid, at: Support) -> Matrix:
    """Return Σ N field ⊗ (x_i - x_p) (in cells) at a point."""
    x0, y0, z0 = middle(at.wx), middle(at.wy), middle(at.wz)
    xx, xy, xz, yx, yy, yz, zx, zy, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for c in range(len(at.wz)):
        for b in range(len(at.wy)):
            row = at.first + (np.uint64(c) * grid.ny + np.uint64(b)) * grid.nx
            for a in range(len(at.wx)):
                node = row + np.uint64(a)
                w = at.wx[a] * at.wy[b] * at.wz[c]
                rx, ry, rz = a - x0, b - y0, c - z0
                x, y, z = w * field[node, 0], w * field[node, 1], w * field[node, 2]
                xx += x * rx
                xy += x * ry
                xz += x * rz
                yx += y * rx
                yy += y * ry
                yz += y * rz
                zx += z * rx
                zy += z * ry
                zz += z * rz
    return Matrix(xx, xy, xz, yx, yy, yz, zx, zy, zz)


@inline
def spread_affine(grid: Grid, at: Support, m: float, v: tuple[float, float, float], C: Matrix) -> None:
    """Add N m and N m (v + C (x_i - x_p)) to the nodes' momentum; C is per cell."""
    momentum = grid.momentum
    x0, y0, z0 = middle(at.wx), middle(at.wy), middle(at.wz)
    for c in range(len(at.wz)):
        for b in range(len(at.wy)):
            row = at.first + (np.uint64(c) * grid.ny + np.uint64(b)) * grid.nx
            for a in range(len(at.wx)):
                node = row + np.uint64(a)
                w = m * at.wx[a] * at.wy[b] * at.wz[c]
                rx, ry, rz = a - x0, b - y0, c - z0
                momentum[node, 0] += w * (v[0] + C.xx * rx + C.xy * ry + C.xz * rz)
                momentum[node, 1] += w * (v[1] + C.yx * rx + C.yy * ry + C.yz * rz)
                momentum[node, 2] += w * (v[2] + C.zx * rx + C.zy * ry + C.zz * rz)
                momentum[node, 3] += w


@inline
def spread_force(grid: Grid, at: Support, s: Sym) -> None:
    """Add s · ∇N (per cell) to the nodes' force."""
    force = grid.change
    for c in range(len(at.wz)):
        for b in range(len(at.wy)):
            row = at.first + (np.uint64(c) * grid.ny + np.uint64(b)) * grid.nx
            for a in range(len(at.wx)):
                node = row + np.uint64(a)
                gx = at.dx[a] * at.wy[b] * at.wz[c]
                gy = at.wx[a] * at.dy[b] * at.wz[c]
                gz = at.wx[a] * at.wy[b] * at.dz[c]
                force[node, 0] += s.xx * gx + s.xy * gy + s.zx * gz
                force[node, 1] += s.xy * gx + s.yy * gy + s.yz * gz
                force[node, 2] += s.zx * gx + s.yz * gy + s.zz * gz
                force[node, 3] += 0.0  # keeps the row one vector
    pull_in(at, force, grid, s.yy)


@inline
def stored_matrix(rows: Array, p: int, scale: float) -> Matrix:
    """Return ``scale`` times the tensor in row p."""
    a = rows[p]
    return Matrix(
        scale * a[0], scale * a[1], scale * a[2],
        scale * a[3], scale * a[4], scale * a[5],
        scale * a[6], scale * a[7], scale * a[8],
    )  # fmt: skip


@inline
def store_matrix(rows: Array, p: int, scale: float, a: Matrix) -> None:
    """Store ``scale`` times a tensor in row p."""
    for n in range(9):
        rows[p, n] = scale * a[n]
