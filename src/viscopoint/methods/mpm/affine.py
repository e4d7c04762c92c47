"""Points that carry a velocity gradient: what they give to the nodes around them, v_p + C (x_i - x_p)."""

from typing import Any

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import inline
from viscopoint.kernels.tensors import Matrix, Sym
from viscopoint.kernels.values import replaced
from viscopoint.kernels.vectors import Float4
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.shapes import Weights
from viscopoint.methods.mpm.stencil import (
    Stencil,
    interpolate_with_gradient,
    scatter,
    scatter_gradient,
    scatter_hoop_force,
)


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
def arms(at: Any) -> Stencil:
    """Return the stencil with N (x_i - x_p) (in cells) in place of the slopes along each axis."""
    return Stencil(at.first, at.wx, at.wy, at.wz, leverage(at.wx), leverage(at.wy), leverage(at.wz), 0.0)


@inline
def leverage(weights: Weights) -> Weights:
    """Return N (x_i - x_p) along one axis, in cells."""
    place, turning = middle(weights), weights
    for a in range(len(weights)):
        turning = replaced(turning, a, weights[a] * (a - place))
    return turning


@inline
def moment(field: Array, grid: Grid, at: Any) -> Matrix:
    """Return Σ N field ⊗ (x_i - x_p) (in cells) at a point."""
    _, x, y, z = interpolate_with_gradient(field, grid, arms(at))
    return Matrix(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z)


@inline
def affine_energy(at: Any, C: Matrix) -> float:
    """Return Σ N |C (x_i - x_p)|² / 2 = tr(C D C^T) / 2 at a point, with C per cell: energy per mass [mm²/ms²]."""
    x, y, z = inertia(at.wx), inertia(at.wy) if len(at.wy) > 1 else 0.0, inertia(at.wz)
    return 0.5 * (
        x * (C.xx * C.xx + C.yx * C.yx + C.zx * C.zx)
        + y * (C.xy * C.xy + C.yy * C.yy + C.zy * C.zy)
        + z * (C.xz * C.xz + C.yz * C.yz + C.zz * C.zz)
    )


@inline
def scatter_affine(grid: Grid, at: Any, m: float, v: tuple[float, float, float], C: Matrix) -> None:
    """Add N m and N m (v + C (x_i - x_p)) to the nodes' momentum; C is per cell."""
    scatter(grid.momentum, grid, at, m * v[0], m * v[1], m * v[2], m)
    x, y, z = Float4(C.xx, C.yx, C.zx, 0.0), Float4(C.xy, C.yy, C.zy, 0.0), Float4(C.xz, C.yz, C.zz, 0.0)
    scatter_gradient(grid.momentum, grid, arms(at), m * x, m * y, m * z)


@inline
def scatter_force(grid: Grid, at: Any, s: Sym) -> None:
    """Add s · ∇N (per cell) to the nodes' force."""
    x, y, z = Float4(s.xx, s.xy, s.zx, 0.0), Float4(s.xy, s.yy, s.yz, 0.0), Float4(s.zx, s.yz, s.zz, 0.0)
    scatter_gradient(grid.force, grid, at, x, y, z)
    scatter_hoop_force(at, grid.force, grid, s.yy)


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
