"""Small tensors as values: symmetric (stress, strain) and general (velocity gradient, rotation) 3 x 3.

A ``Sym`` adds, subtracts and scales like the tensor it is, in Python and inside kernels alike, where it lives in
registers. Components stand in the order xx yy zz xy yz zx everywhere in the package.
"""

import math
import operator
from dataclasses import dataclass
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


# --- operations ------------------------------------------------------------------------------------------------------


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


# --- Sym inside kernels ----------------------------------------------------------------------------------------------


class _SymType(types.Type):
    def __init__(self) -> None:
        super().__init__(name="Sym")


_SYM = _SymType()


@typeof_impl.register(Sym)
def _type_of(value: Sym, context: Any) -> Any:
    return _SYM


@register_model(_SymType)
class _SymModel(models.StructModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, [(name, types.float64) for name in COMPONENTS])


for _name in COMPONENTS:
    make_attribute_wrapper(_SymType, _name, _name)


@type_callable(Sym)
def _type_sym(context: Any) -> Any:
    def typed(xx: Any, yy: Any, zz: Any, xy: Any, yz: Any, zx: Any) -> Any:
        return _SYM

    return typed


@lower_builtin(Sym, *[types.Any] * len(COMPONENTS))
def _build_sym(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    tensor = cgutils.create_struct_proxy(_SYM)(context, builder)
    for name, value, kind in zip(COMPONENTS, values, signature.args, strict=True):
        setattr(tensor, name, context.cast(builder, value, kind, types.float64))
    return tensor._getvalue()


def _inside_kernels(symbol: Any, implementation: Any, left: type, right: type) -> None:
    @overload(symbol, strict=False, jit_options=INLINED)
    def resolve(a: Any, b: Any) -> Any:
        return implementation if isinstance(a, left) and isinstance(b, right) else None


_inside_kernels(operator.add, _add, _SymType, _SymType)
_inside_kernels(operator.sub, _subtract, _SymType, _SymType)
_inside_kernels(operator.mul, _scale, types.Number, _SymType)
