"""Small tensors of finite deformation."""

from viscopoint.kernels.jit import inline
from viscopoint.kernels.tensors import Matrix, Sym, inner, minor
from viscopoint.kernels.values import fma


@inline
def added(a: Matrix, scale: float, b: Matrix) -> Matrix:
    """Return a + scale b."""
    return Matrix(
        fma(scale, b.xx, a.xx), fma(scale, b.xy, a.xy), fma(scale, b.xz, a.xz),
        fma(scale, b.yx, a.yx), fma(scale, b.yy, a.yy), fma(scale, b.yz, a.yz),
        fma(scale, b.zx, a.zx), fma(scale, b.zy, a.zy), fma(scale, b.zz, a.zz),
    )  # fmt: skip


@inline
def cofactor(a: Matrix) -> Matrix:
    """Return det(a) a⁻ᵀ: what the map a makes of areas (Nanson)."""
    return Matrix(
        minor(a.yy, a.yz, a.zy, a.zz), minor(a.yz, a.yx, a.zz, a.zx), minor(a.yx, a.yy, a.zx, a.zy),
        minor(a.xz, a.xy, a.zz, a.zy), minor(a.xx, a.xz, a.zx, a.zz), minor(a.xy, a.xx, a.zy, a.zx),
        minor(a.xy, a.xz, a.yy, a.yz), minor(a.xz, a.xx, a.yz, a.yx), minor(a.xx, a.xy, a.yx, a.yy),
    )  # fmt: skip


@inline
def times_transposed(k: float, a: Matrix, b: Matrix) -> Matrix:
    """Return k a bᵀ."""
    return Matrix(
        k * inner(a.xx, b.xx, a.xy, b.xy, a.xz, b.xz),
        k * inner(a.xx, b.yx, a.xy, b.yy, a.xz, b.yz),
        k * inner(a.xx, b.zx, a.xy, b.zy, a.xz, b.zz),
        k * inner(a.yx, b.xx, a.yy, b.xy, a.yz, b.xz),
        k * inner(a.yx, b.yx, a.yy, b.yy, a.yz, b.yz),
        k * inner(a.yx, b.zx, a.yy, b.zy, a.yz, b.zz),
        k * inner(a.zx, b.xx, a.zy, b.xy, a.zz, b.xz),
        k * inner(a.zx, b.yx, a.zy, b.yy, a.zz, b.yz),
        k * inner(a.zx, b.zx, a.zy, b.zy, a.zz, b.zz),
    )


@inline
def on_areas(s: Sym, b: Matrix) -> Matrix:
    """Return s b: of the cofactor b of F, the first Piola-Kirchhoff stress."""
    return Matrix(
        inner(s.xx, b.xx, s.xy, b.yx, s.zx, b.zx),
        inner(s.xx, b.xy, s.xy, b.yy, s.zx, b.zy),
        inner(s.xx, b.xz, s.xy, b.yz, s.zx, b.zz),
        inner(s.xy, b.xx, s.yy, b.yx, s.yz, b.zx),
        inner(s.xy, b.xy, s.yy, b.yy, s.yz, b.zy),
        inner(s.xy, b.xz, s.yy, b.yz, s.yz, b.zz),
        inner(s.zx, b.xx, s.yz, b.yx, s.zz, b.zx),
        inner(s.zx, b.xy, s.yz, b.yy, s.zz, b.zy),
        inner(s.zx, b.xz, s.yz, b.yz, s.zz, b.zz),
    )


@inline
def square(k: float, a: Matrix) -> Sym:
    """Return k² aᵀ a; of cofactor and determinant of F, the inverse of C = Fᵀ F."""
    k2 = k * k
    return Sym(
        k2 * inner(a.xx, a.xx, a.yx, a.yx, a.zx, a.zx),
        k2 * inner(a.xy, a.xy, a.yy, a.yy, a.zy, a.zy),
        k2 * inner(a.xz, a.xz, a.yz, a.yz, a.zz, a.zz),
        k2 * inner(a.xx, a.xy, a.yx, a.yy, a.zx, a.zy),
        k2 * inner(a.xy, a.xz, a.yy, a.yz, a.zy, a.zz),
        k2 * inner(a.xz, a.xx, a.yz, a.yx, a.zz, a.zx),
    )


@inline
def steepest(a: Sym) -> float:
    """Return a bound on the largest eigenvalue: the greatest sum of absolute values in a row; exact for diag."""
    xy, yz, zx = abs(a.xy), abs(a.yz), abs(a.zx)
    return max(a.xx + xy + zx, a.yy + xy + yz, a.zz + yz + zx)
