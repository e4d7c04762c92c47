"""Small tensors as values: vectors, symmetric (stress, strain) and general (velocity gradient, rotation) 3 x 3.

A ``Vec`` or ``Sym`` adds, subtracts and scales like the tensor it is, in Python and inside kernels alike, where it
lives in registers. Components stand in the order xx yy zz xy yz zx everywhere in the package.
"""

import inspect
import math
import operator
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

from numba import types
from numba.core import cgutils
from numba.extending import (
    lower_builtin,
    make_attribute_wrapper,
    models,
    overload,
    register_model,
    type_callable,
    typeof_impl,
)

from viscopoint.jit import INLINED, inline

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


# --- vectors ---------------------------------------------------------------------------------------------------------


def _add_vectors(a: Vec, b: Vec) -> Vec:
    return Vec(a.x + b.x, a.y + b.y, a.z + b.z)


def _subtract_vectors(a: Vec, b: Vec) -> Vec:
    return Vec(a.x - b.x, a.y - b.y, a.z - b.z)


def _scale_vector(k: float, a: Vec) -> Vec:
    return Vec(k * a.x, k * a.y, k * a.z)


@inline
def dot(a: Vec, b: Vec) -> float:
    """Return a · b."""
    return a.x * b.x + a.y * b.y + a.z * b.z


@inline
def cross(a: Vec, b: Vec) -> Vec:
    """Return a x b."""
    return Vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


# --- general tensors -------------------------------------------------------------------------------------------------


@inline
def from_rows(x: Vec, y: Vec, z: Vec) -> Matrix:
    """Return the tensor with the given rows."""
    return Matrix(x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z)


@inline
def applied(a: Matrix, v: Vec) -> Vec:
    """Return a v."""
    return Vec(
        a.xx * v.x + a.xy * v.y + a.xz * v.z,
        a.yx * v.x + a.yy * v.y + a.yz * v.z,
        a.zx * v.x + a.zy * v.y + a.zz * v.z,
    )


@inline
def determinant(a: Matrix) -> float:
    """Return det a."""
    return a.xx * (a.yy * a.zz - a.yz * a.zy) - a.xy * (a.yx * a.zz - a.yz * a.zx) + a.xz * (a.yx * a.zy - a.yy * a.zx)


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
def stretched(a: Sym, v: Vec) -> Vec:
    """Return a v."""
    return Vec(
        a.xx * v.x + a.xy * v.y + a.zx * v.z, a.xy * v.x + a.yy * v.y + a.yz * v.z, a.zx * v.x + a.yz * v.y + a.zz * v.z
    )


@inline
def deviator(a: Sym) -> Sym:
    """Return a' = a - (tr a / 3) I."""
    return a - spherical(trace(a) / 3.0)


@inline
def contract(a: Sym, b: Sym) -> float:
    """Return a : b."""
    return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + 2.0 * (a.xy * b.xy + a.yz * b.yz + a.zx * b.zx)


@inline
def von_mises(stress: Sym) -> float:
    """Return sqrt(3/2 S : S)."""
    shape = deviator(stress)
    return math.sqrt(1.5 * contract(shape, shape))


@inline
def rotated(a: Sym, turn: Matrix) -> Sym:
    """Return Q a Qᵀ for the rotation Q = turn."""
    xx = turn.xx * a.xx + turn.xy * a.xy + turn.xz * a.zx  # Q a, row by row
    xy = turn.xx * a.xy + turn.xy * a.yy + turn.xz * a.yz
    xz = turn.xx * a.zx + turn.xy * a.yz + turn.xz * a.zz
    yx = turn.yx * a.xx + turn.yy * a.xy + turn.yz * a.zx
    yy = turn.yx * a.xy + turn.yy * a.yy + turn.yz * a.yz
    yz = turn.yx * a.zx + turn.yy * a.yz + turn.yz * a.zz
    zx = turn.zx * a.xx + turn.zy * a.xy + turn.zz * a.zx
    zy = turn.zx * a.xy + turn.zy * a.yy + turn.zz * a.yz
    zz = turn.zx * a.zx + turn.zy * a.yz + turn.zz * a.zz
    return Sym(
        xx * turn.xx + xy * turn.xy + xz * turn.xz,
        yx * turn.yx + yy * turn.yy + yz * turn.yz,
        zx * turn.zx + zy * turn.zy + zz * turn.zz,
        xx * turn.yx + xy * turn.yy + xz * turn.yz,
        yx * turn.zx + yy * turn.zy + yz * turn.zz,
        zx * turn.xx + zy * turn.xy + zz * turn.xz,
    )


@inline
def spun(a: Sym, x: float, y: float, z: float) -> Sym:
    """Return W a - a W for the antisymmetric W with axial vector (x, y, z): the rate of a tensor that turns with W."""
    return Sym(
        2.0 * (y * a.zx - z * a.xy),
        2.0 * (z * a.xy - x * a.yz),
        2.0 * (x * a.yz - y * a.zx),
        z * (a.xx - a.yy) + y * a.yz - x * a.zx,
        x * (a.yy - a.zz) + z * a.zx - y * a.xy,
        y * (a.zz - a.xx) + x * a.xy - z * a.yz,
    )


@inline
def read(row: Any) -> Sym:
    """Read a tensor from the six values of an array row or a tuple."""
    return Sym(row[0], row[1], row[2], row[3], row[4], row[5])


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


# --- values inside kernels -------------------------------------------------------------------------------------------


def _register(value: type) -> type:
    """Let kernels hold a class of floats as a struct, read its fields and construct it; return its Numba type."""
    names = [field.name for field in fields(value)]

    class ValueType(types.Type):
        def __init__(self) -> None:
            super().__init__(name=value.__name__)

    kind = ValueType()

    @typeof_impl.register(value)
    def type_of(instance: Any, context: Any) -> Any:
        return kind

    @register_model(ValueType)
    class ValueModel(models.StructModel):
        def __init__(self, manager: Any, kind: Any) -> None:
            super().__init__(manager, kind, [(name, types.float64) for name in names])

    for name in names:
        make_attribute_wrapper(ValueType, name, name)

    @type_callable(value)
    def type_constructor(context: Any) -> Any:
        def typed(*given: Any, **named: Any) -> Any:
            return kind

        typed.__signature__ = inspect.signature(value)  # pyright: ignore[reportFunctionMemberAccess]  (Numba reads it)
        return typed

    @lower_builtin(value, *[types.Any] * len(names))
    def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        made = cgutils.create_struct_proxy(kind)(context, builder)
        for name, given, given_kind in zip(names, values, signature.args, strict=True):
            setattr(made, name, context.cast(builder, given, given_kind, types.float64))
        return made._getvalue()

    return ValueType


def _inside_kernels(symbol: Any, implementation: Any, left: type, right: type) -> None:
    @overload(symbol, strict=False, jit_options=INLINED)
    def resolve(a: Any, b: Any) -> Any:
        return implementation if isinstance(a, left) and isinstance(b, right) else None


for _value, _plus, _minus, _times in (
    (_register(Vec), _add_vectors, _subtract_vectors, _scale_vector),
    (_register(Sym), _add, _subtract, _scale),
):
    _inside_kernels(operator.add, _plus, _value, _value)
    _inside_kernels(operator.sub, _minus, _value, _value)
    _inside_kernels(operator.mul, _times, types.Number, _value)
