"""Small tensors of finite deformation."""

from viscopoint.jit import inline
from viscopoint.tensors import Matrix, Sym


@inline
def added(a: Matrix, scale: float, b: Matrix) -> Matrix:
    """Return a + scale b."""
    return Matrix(
        a.xx + scale * b.xx, a.xy + scale * b.xy, a.xz + scale * b.xz,
        a.yx + scale * b.yx, a.yy + scale * b.yy, a.yz + scale * b.yz,
        a.zx + scale * b.zx, a.zy + scale * b.zy, a.zz + scale * b.zz,
    )  # fmt: skip


@inline
def cofactor(a: Matrix) -> Matrix:
    """Return det(a) a⁻ᵀ: what the map a makes of areas (Nanson)."""
    return Matrix(
        a.yy * a.zz - a.yz * a.zy, a.yz * a.zx - a.yx * a.zz, a.yx * a.zy - a.yy * a.zx,
        a.xz * a.zy - a.xy * a.zz, a.xx * a.zz - a.xz * a.zx, a.xy * a.zx - a.xx * a.zy,
        a.xy * a.yz - a.xz * a.yy, a.xz * a.yx - a.xx * a.yz, a.xx * a.yy - a.xy * a.yx,
    )  # fmt: skip


@inline
def times_transposed(k: float, a: Matrix, b: Matrix) -> Matrix:
    """Return k a bᵀ."""
    return Matrix(
        k * (a.xx * b.xx + a.xy * b.xy + a.xz * b.xz),
        k * (a.xx * b.yx + a.xy * b.yy + a.xz * b.yz),
        k * (a.xx * b.zx + a.xy * b.zy + a.xz * b.zz),
        k * (a.yx * b.xx + a.yy * b.xy + a.yz * b.xz),
        k * (a.yx * b.yx + a.yy * b.yy + a.yz * b.yz),
        k * (a.yx * b.zx + a.yy * b.zy + a.yz * b.zz),
        k * (a.zx * b.xx + a.zy * b.xy + a.zz * b.xz),
        k * (a.zx * b.yx + a.zy * b.yy + a.zz * b.yz),
        k * (a.zx * b.zx + a.zy * b.zy + a.zz * b.zz),
    )


@inline
def on_areas(s: Sym, b: Matrix) -> Matrix:
    """Return s b: of the cofactor b of F, the first Piola-Kirchhoff stress."""
    return Matrix(
        s.xx * b.xx + s.xy * b.yx + s.zx * b.zx,
        s.xx * b.xy + s.xy * b.yy + s.zx * b.zy,
        s.xx * b.xz + s.xy * b.yz + s.zx * b.zz,
        s.xy * b.xx + s.yy * b.yx + s.yz * b.zx,
        s.xy * b.xy + s.yy * b.yy + s.yz * b.zy,
        s.xy * b.xz + s.yy * b.yz + s.yz * b.zz,
        s.zx * b.xx + s.yz * b.yx + s.zz * b.zx,
        s.zx * b.xy + s.yz * b.yy + s.zz * b.zy,
        s.zx * b.xz + s.yz * b.yz + s.zz * b.zz,
    )


@inline
def square(k: float, a: Matrix) -> Sym:
    """Return k² aᵀ a; of cofactor and determinant of F, the inverse of C = Fᵀ F."""
    k2 = k * k
    return Sym(
        k2 * (a.xx * a.xx + a.yx * a.yx + a.zx * a.zx),
        k2 * (a.xy * a.xy + a.yy * a.yy + a.zy * a.zy),
        k2 * (a.xz * a.xz + a.yz * a.yz + a.zz * a.zz),
        k2 * (a.xx * a.xy + a.yx * a.yy + a.zx * a.zy),
        k2 * (a.xy * a.xz + a.yy * a.yz + a.zy * a.zz),
        k2 * (a.xz * a.xx + a.yz * a.yx + a.zz * a.zx),
    )


@inline
def steepest(a: Sym) -> float:
    """Return a bound on the largest eigenvalue: the greatest sum of absolute values in a row; exact for diag."""
    xy, yz, zx = abs(a.xy), abs(a.yz), abs(a.zx)
    return max(a.xx + xy + zx, a.yy + xy + yz, a.zz + yz + zx)
