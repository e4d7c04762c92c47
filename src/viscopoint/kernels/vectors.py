"""Vectors as values, and the products of which sums are fused.

A ``Vec`` or ``Float4`` adds, subtracts and scales like the vector it is, in Python and inside kernels alike, where it
lives in registers.
"""

import operator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import types

from viscopoint.kernels import values
from viscopoint.kernels.jit import inline
from viscopoint.kernels.values import fma, inside_kernels


@dataclass(frozen=True, slots=True)
class Vec:
    """A vector."""

    x: float
    y: float
    z: float

    def __add__(self, other: "Vec") -> "Vec":
        return Vec(self.x + other.x, self.y + other.y, self.z + other.z)

    def __sub__(self, other: "Vec") -> "Vec":
        return Vec(self.x - other.x, self.y - other.y, self.z - other.z)

    def __rmul__(self, factor: float) -> "Vec":
        return _scale(factor, self)


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


def _scale(k: float, a: Vec) -> Vec:
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


_VEC, _FLOAT4 = values.register_struct(Vec), values.register_float4(Float4)
inside_kernels(operator.add, Vec.__add__, _VEC, _VEC)
inside_kernels(operator.sub, Vec.__sub__, _VEC, _VEC)
inside_kernels(operator.mul, _scale, types.Number, _VEC)
inside_kernels(fma, _fma_vectors, types.Number, _VEC, _VEC)
inside_kernels(fma, values.accumulated(), types.Number, _FLOAT4, _FLOAT4)
inside_kernels(operator.add, values.summed(), _FLOAT4, _FLOAT4)
inside_kernels(operator.mul, values.scaled(), types.Number, _FLOAT4)
inside_kernels(fetch, values.fetched(Float4), types.Array, types.Integer)
inside_kernels(put, values.stored(), types.Array, types.Integer, _FLOAT4)
