"""Small tensors as values: vectors, symmetric (stress, strain) and general (velocity gradient, rotation) 3 x 3.

A ``Vec``, ``Float4`` or ``Sym`` adds, subtracts and scales like the tensor it is, in Python and inside kernels alike,
where it lives in registers. Components stand in the order xx yy zz xy yz zx everywhere in the package.
"""

import math
import operator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import types

from viscopoint.kernels.jit import inline
from viscopoint.kernels.values import (
    accumulated,
    fetched,
    fma,
    inside_kernels,
    register_float4,
    register_struct,
    scaled,
    stored,
    summed,
)

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")


@dataclass(frozen=True, slots=True)
class Vec:
    """A vector."""

    x: float
    y: float
    z: float

    def __add__(self, other: "Vec") -> "Vec":
        return _add_vectors(self, other)

    def __sub__(self, other: "Vec") -> "Vec":
        return _subtract_vectors(self, other)

    def __rmul__(self, factor: float) -> "Vec":
        return _scale_vector(factor, self)


@dataclass(frozen=True, slots=True)
class Float4:
    """A row of the nodes' arrays ``[n, 4]``: a vector and what goes with it, in one vector register."""

    x: float
    y: float
    z: float
    w: float

    def __add__(self, other: "Float4") -> "Float4":
        return Float4(self.x + other.x, self.y + other.y, self.z + other.z, self.w + other.w)

    def __rmul__(self, factor: float) -> "Float4":
        return Float4(factor * self.x, factor * self.y, factor * self.z, factor * self.w)


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
        return _add(self, other)

    def __sub__(self, other: "Sym") -> "Sym":
        return _subtract(self, other)

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


# --- vectors ---------------------------------------------------------------------------------------------------------


def _add_vectors(a: Vec, b: Vec) -> Vec:
    return Vec(a.x + b.x, a.y + b.y, a.z + b.z)


def _subtract_vectors(a: Vec, b: Vec) -> Vec:
    return Vec(a.x - b.x, a.y - b.y, a.z - b.z)


def _scale_vector(k: float, a: Vec) -> Vec:
    return Vec(k * a.x, k * a.y, k * a.z)


def _fma_vectors(k: float, a: Vec, b: Vec) -> Vec:
    return Vec(fma(k, a.x, b.x), fma(k, a.y, b.y), fma(k, a.z, b.z))


@inline
def inner(a: float, x: float, b: float, y: float, c: float, z: float) -> float:
    """Return a x + b y + c z."""
    return fma(a, x, fma(b, y, c * z))


@inline
def minor(a: float, b: float, c: float, d: float) -> float:
    """Return a d - b c, the determinant of ((a, b), (c, d))."""
    return fma(a, d, -(b * c))


def fetch(rows: Any, n: Any) -> Float4:
    """Read row n of ``rows[n, 4]``."""
    return Float4(*rows[n])


def put(rows: Any, n: Any, a: Float4) -> None:
    """Store a row of ``rows[n, 4]``."""
    rows[n] = a.x, a.y, a.z, a.w


@inline
def zeros4() -> Float4:
    """Return nil."""
    return Float4(0.0, 0.0, 0.0, 0.0)


@inline
def product(a: Vec, b: Vec) -> Vec:
    """Return the products of the components."""
    return Vec(a.x * b.x, a.y * b.y, a.z * b.z)


@inline
def fma_product(a: Vec, b: Vec, c: Vec) -> Vec:
    """Return the products of the components of a and b, plus those of c, each rounded once."""
    return Vec(fma(a.x, b.x, c.x), fma(a.y, b.y, c.y), fma(a.z, b.z, c.z))


@inline
def read_vector(row: Any, first: int = 0) -> Vec:
    """Read a vector, in double, from three values of an array row."""
    real = np.float64
    return Vec(real(row[first]), real(row[first + 1]), real(row[first + 2]))


@inline
def write_vector(row: Any, a: Vec, first: int = 0) -> None:
    """Store a vector in three values of an array row."""
    row[first] = a.x
    row[first + 1] = a.y
    row[first + 2] = a.z


@inline
def total(a: Vec) -> float:
    """Return the sum of the components."""
    return a.x + a.y + a.z


@inline
def dot(a: Vec, b: Vec) -> float:
    """Return a · b."""
    return inner(a.x, b.x, a.y, b.y, a.z, b.z)


@inline
def cross(a: Vec, b: Vec) -> Vec:
    """Return a x b."""
    return Vec(minor(a.y, a.z, b.y, b.z), minor(a.z, a.x, b.z, b.x), minor(a.x, a.y, b.x, b.y))


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
    return Columns(Vec(a.xx, a.xy, a.zx), Vec(a.xy, a.yy, a.yz), Vec(a.zx, a.yz, a.zz))


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


def _add(a: Sym, b: Sym) -> Sym:
    return Sym(a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx)


def _subtract(a: Sym, b: Sym) -> Sym:
    return Sym(a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.yz - b.yz, a.zx - b.zx)


def _scale(k: float, a: Sym) -> Sym:
    return Sym(k * a.xx, k * a.yy, k * a.zz, k * a.xy, k * a.yz, k * a.zx)


@inline
def spherical(mean: float) -> Sym:
    """Return mean I."""
    return Sym(mean, mean, mean, 0.0, 0.0, 0.0)


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
    """Return Q a Qᵀ for the rotation Q = q."""
    xx = inner(q.xx, a.xx, q.xy, a.xy, q.xz, a.zx)  # Q a, row by row
    xy = inner(q.xx, a.xy, q.xy, a.yy, q.xz, a.yz)
    xz = inner(q.xx, a.zx, q.xy, a.yz, q.xz, a.zz)
    yx = inner(q.yx, a.xx, q.yy, a.xy, q.yz, a.zx)
    yy = inner(q.yx, a.xy, q.yy, a.yy, q.yz, a.yz)
    yz = inner(q.yx, a.zx, q.yy, a.yz, q.yz, a.zz)
    zx = inner(q.zx, a.xx, q.zy, a.xy, q.zz, a.zx)
    zy = inner(q.zx, a.xy, q.zy, a.yy, q.zz, a.yz)
    zz = inner(q.zx, a.zx, q.zy, a.yz, q.zz, a.zz)
    return Sym(
        inner(xx, q.xx, xy, q.xy, xz, q.xz),
        inner(yx, q.yx, yy, q.yy, yz, q.yz),
        inner(zx, q.zx, zy, q.zy, zz, q.zz),
        inner(xx, q.yx, xy, q.yy, xz, q.yz),
        inner(yx, q.zx, yy, q.zy, yz, q.zz),
        inner(zx, q.xx, zy, q.xy, zz, q.xz),
    )


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


# --- inside kernels --------------------------------------------------------------------------------------------------

_VEC, _FLOAT4, _SYM = register_struct(Vec), register_float4(Float4), register_struct(Sym)
inside_kernels(operator.add, _add_vectors, _VEC, _VEC)
inside_kernels(operator.sub, _subtract_vectors, _VEC, _VEC)
inside_kernels(operator.mul, _scale_vector, types.Number, _VEC)
inside_kernels(fma, _fma_vectors, types.Number, _VEC, _VEC)
inside_kernels(fma, accumulated(), types.Number, _FLOAT4, _FLOAT4)
inside_kernels(operator.add, summed(), _FLOAT4, _FLOAT4)
inside_kernels(operator.mul, scaled(), types.Number, _FLOAT4)
inside_kernels(fetch, fetched(Float4), types.Array, types.Integer)
inside_kernels(put, stored(), types.Array, types.Integer, _FLOAT4)
inside_kernels(operator.add, _add, _SYM, _SYM)
inside_kernels(operator.sub, _subtract, _SYM, _SYM)
inside_kernels(operator.mul, _scale, types.Number, _SYM)
