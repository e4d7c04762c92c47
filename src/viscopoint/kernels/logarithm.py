"""A logarithm that kernels take of several numbers at once: the library's is a call, which keeps loops scalar."""

import math
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload

from viscopoint.kernels.jit import INLINED

LN2 = math.log(2.0)
ROOT_HALF = 0x3FE6A09E667F3BCD  # the bits of sqrt(1/2)


def log(x: float) -> float:
    """Return ln x to 4.5e-16 of itself; not a number for x <= 0."""
    return math.log(x) if x > 0.0 else math.nan


@intrinsic
def _bits(context: Any, x: Any) -> Any:
    """Return the bits of a number."""

    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.bitcast(values[0], ir.IntType(64))

    return types.int64(types.float64), lower


@intrinsic
def _number(context: Any, bits: Any) -> Any:
    """Return the number that has these bits."""

    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.bitcast(values[0], ir.DoubleType())

    return types.float64(types.int64), lower


@overload(log, strict=False, jit_options=INLINED)
def _log(x: Any) -> Any:
    """With x = 2^k m, m in [sqrt(1/2), sqrt(2)) and s = (m - 1) / (m + 1): ln m = 2 (s + s³/3 + s⁵/5 + ...)."""

    def logarithm(x: float) -> float:
        bits = _bits(x)  # pyright: ignore[reportCallIssue]  (an intrinsic)
        k = (bits - ROOT_HALF) >> 52
        m = _number(bits - (k << 52))  # pyright: ignore[reportCallIssue]
        s = (m - 1.0) / (m + 1.0)
        z = s * s  # at most 0.0295: the first term left out, z^11 / 23, is below 1e-18
        series = 1.0 / 21.0
        for odd in (19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0):
            series = series * z + 1.0 / odd
        return k * LN2 + (2.0 * s + 2.0 * s * z * series) if x > 0.0 else math.nan

    return logarithm
