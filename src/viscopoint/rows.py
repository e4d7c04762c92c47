"""Rows of an array as tuples of a length that kernels know when they are compiled, so that they live in registers."""

from typing import Any

from numba.extending import overload
from numba.np.unsafe.ndarray import to_fixed_tuple

from viscopoint.arrays import Array


def load(row: Array, blank: tuple[float, ...]) -> tuple[float, ...]:
    """Return a row of values as a tuple as long as ``blank``, a length that kernels know when compiled."""
    return tuple(row[: len(blank)])


@overload(load, strict=False)
def _load(row: Any, blank: Any) -> Any:
    count = len(blank)

    def some(row: Any, blank: Any) -> Any:
        return to_fixed_tuple(row, count)  # pyright: ignore[reportCallIssue]  (an intrinsic)

    def none(row: Any, blank: Any) -> Any:
        return ()

    return some if count else none


def store(row: Array, values: tuple[float, ...]) -> None:
    """Put values back into their row."""
    row[: len(values)] = values


@overload(store, strict=False)
def _store(row: Any, values: Any) -> Any:
    def some(row: Any, values: Any) -> None:
        for k in range(len(values)):
            row[k] = values[k]

    def none(row: Any, values: Any) -> None:
        pass

    return some if len(values) else none
