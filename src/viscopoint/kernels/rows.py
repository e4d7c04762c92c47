"""Rows of an array as tuples of a length that kernels know when they are compiled, so that they live in registers."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import INLINED


def read_row(row: Array, like: tuple[float, ...]) -> tuple[float, ...]:
    """Return a row of values, in double, as a tuple as long as ``like``, a length that kernels know when compiled."""
    return tuple(row[: len(like)])


def write_row(row: Array, values: tuple[float, ...]) -> None:
    """Put values back into their row."""
    row[: len(values)] = values


@intrinsic
def _read(context: Any, row: Any, like: Any) -> Any:
    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        places = _places(context, builder, signature, values, len(like))
        parts = [context.cast(builder, builder.load(place), row.dtype, types.float64) for place in places]
        return context.make_tuple(builder, signature.return_type, parts)

    return types.UniTuple(types.float64, len(like))(row, like), lower


@intrinsic
def _write(context: Any, row: Any, tuple_: Any) -> Any:
    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        parts = cgutils.unpack_tuple(builder, values[1])
        places = _places(context, builder, signature, values, len(parts))
        for part, kind, place in zip(parts, signature.args[1], places, strict=True):
            builder.store(context.cast(builder, part, kind, row.dtype), place)
        return context.get_dummy_value()

    return types.none(row, tuple_), lower


def _places(context: Any, builder: Any, signature: Any, values: Any, count: int) -> list[Any]:
    """Return the addresses of a contiguous row's first values."""
    row = context.make_array(signature.args[0])(context, builder, values[0])
    return [builder.gep(row.data, [ir.Constant(ir.IntType(64), k)], inbounds=True) for k in range(count)]


@overload(read_row, strict=False, jit_options=INLINED)
def _read_it(row: Any, like: Any) -> Any:
    return lambda row, like: _read(row, like)  # pyright: ignore[reportCallIssue]  (an intrinsic)


@overload(write_row, strict=False, jit_options=INLINED)
def _write_it(row: Any, values: Any) -> Any:
    return lambda row, values: _write(row, values)  # pyright: ignore[reportCallIssue]
