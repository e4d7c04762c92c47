"""Second-order tensors as values: symmetric ones (stress, strain) and general ones (velocity gradient, rotation).

A ``Sym`` adds, subtracts and scales like the tensor it is, in Python and inside kernels alike, where it lives in
registers. Components stand in the order xx yy zz xy yz zx everywhere in the package.
"""

import math
import operator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import types

from viscopoint.kernels.jit import inline
from viscopoint.kernels.values import fma, inside_kernels, register_struct
from viscopoint.kernels.vectors import Vec, inner, minor

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")


@dataclass(frozen=True, slots=True)
class Sym:
    """A symmetric second-order tensor."""

    xx: float
    yy: float
    zz: float
    xy: float
    yz: float
    zx: float

    def __add__(self, other: "Sym") -> "Sym":
        return Sym(
            self.xx + other.xx, self.yy + other.yy, self.zz + other.zz,
            self.xy + other.xy, self.yz + other.yz, self.zx + other.zx,
        )  # fmt: skip

    def __sub__(self, other: "Sym") -> "Sym":
        return Sym(
            self.xx - other.xx, self.yy - other.yy, self.zz - other.zz,
            self.xy - other.xy, self.yz - other.yz, self.zx - other.zx,
        )  # fmt: skip

    def __rmul__(self, factor: float) -> "Sym":
        return _scale(factor, self)


class Matrix(NamedTuple):
    """A general second-order tensor, row by row."""

    xx: float
    xy: float
    xz: float
    yx: float
    yy: float
    yz: float
    zx: float
    zy: float
    zz: float


class Columns(NamedTuple):
    """A general second-order tensor, column by column: what it makes of the three axes."""

    x: Vec
    y: Vec
    z: Vec


IDENTITY = Matrix(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


# --- general tensors -------------------------------------------------------------------------------------------------


@inline
def applied(a: Columns, v: Vec) -> Vec:
    """Return a v."""
    return fma(v.z, a.z, fma(v.y, a.y, v.x * a.x))


@inline
def columns(a: Matrix) -> Columns:
    """Return the tensor column by column."""
    return Columns(Vec(a.xx, a.yx, a.zx), Vec(a.xy, a.yy, a.zy), Vec(a.xz, a.yz, a.zz))


@inline
def sym_columns(a: Sym) -> Columns:
    """Return the tensor column by column."""
    return columns(full(a))


@inline
def matrix(a: Columns) -> Matrix:
    """Return the tensor row by row."""
    return Matrix(a.x.x, a.y.x, a.z.x, a.x.y, a.y.y, a.z.y, a.x.z, a.y.z, a.z.z)


@inline
def determinant(a: Matrix) -> float:
    """Return det a."""
    x, y, z = minor(a.yy, a.yz, a.zy, a.zz), minor(a.yz, a.yx, a.zz, a.zx), minor(a.yx, a.yy, a.zx, a.zy)
    return inner(a.xx, x, a.xy, y, a.xz, z)


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
def times(a: Matrix, b: Matrix) -> Matrix:
    """Return a b."""
    return times_transposed(1.0, a, transposed(b))


@inline
def transposed(a: Matrix) -> Matrix:
    """Return aᵀ."""
    return Matrix(a.xx, a.yx, a.zx, a.xy, a.yy, a.zy, a.xz, a.yz, a.zz)


# --- symmetric tensors -----------------------------------------------------------------------------------------------


def _scale(k: float, a: Sym) -> Sym:
    return Sym(k * a.xx, k * a.yy, k * a.zz, k * a.xy, k * a.yz, k * a.zx)


@inline
def spherical(mean: float) -> Sym:
    """Return mean I."""
    return Sym(mean, mean, mean, 0.0, 0.0, 0.0)


@inline
def symmetric(a: Matrix) -> Sym:
    """Return (a + aᵀ) / 2."""
    return Sym(a.xx, a.yy, a.zz, 0.5 * (a.xy + a.yx), 0.5 * (a.yz + a.zy), 0.5 * (a.zx + a.xz))


@inline
def full(a: Sym) -> Matrix:
    """Return the tensor row by row."""
    return Matrix(a.xx, a.xy, a.zx, a.xy, a.yy, a.yz, a.zx, a.yz, a.zz)


@inline
def trace(a: Sym) -> float:
    """Return tr a."""
    return a.xx + a.yy + a.zz


@inline
def deviator(a: Sym) -> Sym:
    """Return a' = a - (tr a / 3) I."""
    return a - spherical(trace(a) / 3.0)


@inline
def contract(a: Sym, b: Sym) -> float:
    """Return a : b."""
    return fma(2.0, inner(a.xy, b.xy, a.yz, b.yz, a.zx, b.zx), inner(a.xx, b.xx, a.yy, b.yy, a.zz, b.zz))


@inline
def von_mises(stress: Sym) -> float:
    """Return sqrt(3/2 S : S)."""
    shape = deviator(stress)
    return math.sqrt(1.5 * contract(shape, shape))


@inline
def rotated(a: Sym, q: Matrix) -> Sym:
    """Return Q a Qᵀ for the rotation Q."""
    r = times_transposed(1.0, times_transposed(1.0, q, full(a)), q)
    return Sym(r.xx, r.yy, r.zz, r.xy, r.yz, r.zx)


@inline
def spun(a: Sym, x: float, y: float, z: float) -> Sym:
    """Return W a - a W for the antisymmetric W with axial vector (x, y, z): the rate of a tensor that turns with W."""
    return Sym(
        2.0 * minor(y, z, a.xy, a.zx),
        2.0 * minor(z, x, a.yz, a.xy),
        2.0 * minor(x, y, a.zx, a.yz),
        fma(z, a.xx - a.yy, minor(y, x, a.zx, a.yz)),
        fma(x, a.yy - a.zz, minor(z, y, a.xy, a.zx)),
        fma(y, a.zz - a.xx, minor(x, z, a.yz, a.xy)),
    )


@inline
def read(row: Any) -> Sym:
    """Read a tensor, in double, from the six values of an array row or a tuple."""
    real = np.float64
    return Sym(real(row[0]), real(row[1]), real(row[2]), real(row[3]), real(row[4]), real(row[5]))


@inline
def write(row: Any, a: Sym) -> None:
    """Store a tensor in the six values of an array row."""
    row[0] = a.xx
    row[1] = a.yy
    row[2] = a.zz
    row[3] = a.xy
    row[4] = a.yz
    row[5] = a.zx


@inline
def components(a: Sym) -> tuple[float, float, float, float, float, float]:
    """Return the six components as a tuple."""
    return (a.xx, a.yy, a.zz, a.xy, a.yz, a.zx)


@inline
def on_areas(s: Sym, b: Matrix) -> Matrix:
    """Return s b: of the cofactor b of F, the first Piola-Kirchhoff stress."""
    return times(full(s), b)


@inline
def square(k: float, a: Matrix) -> Sym:
    """Return k² aᵀ a; of cofactor and determinant of F, the inverse of C = Fᵀ F."""
    return symmetric(times_transposed(k * k, transposed(a), transposed(a)))


@inline
def steepest(a: Sym) -> float:
    """Return a bound on the largest eigenvalue: the greatest sum of absolute values in a row; exact for diag."""
    xy, yz, zx = abs(a.xy), abs(a.yz), abs(a.zx)
    return max(a.xx + xy + zx, a.yy + xy + yz, a.zz + yz + zx)


_SYM = register_struct(Sym)
inside_kernels(operator.add, Sym.__add__, _SYM, _SYM)
inside_kernels(operator.sub, Sym.__sub__, _SYM, _SYM)
inside_kernels(operator.mul, _scale, types.Number, _SYM)
