"""Shape functions of the background grid: one short file each, found by itself.

A shape function is a NamedTuple (of its parameters, if it has any), offered under the name that a case uses, and an
implementation of ``stencil``. The three axes are independent: N(x, y, z) = N(x) N(y) N(z).
"""

from collections.abc import Callable
from typing import Any, Protocol, Self, TypeVar

from viscopoint.discovery import import_all
from viscopoint.jit import generic

T = TypeVar("T")
Weights = tuple[float, ...]


class Shape(Protocol):
    """What the method asks of a shape function beside ``stencil``."""

    @classmethod
    def fitted(cls, width: float) -> Self:
        """Return the shape function for points that stand ``width`` cells apart at the start, at most one."""
        ...

    @property
    def overhang(self) -> int:
        """How many nodes before its own cell's first one a point may act on, along each axis."""
        ...


SHAPES: dict[str, type[Shape]] = {}


@generic
def stencil(shape: Any, place: float) -> tuple[int, Weights, Weights]:
    """Return where a point acts along one axis.

    Args:
        shape: the shape function.
        place: the point's coordinate in cells from the grid's first node, >= ``overhang``.

    Returns:
        The first node (uint64), the weights of it and its successors, and their slopes per cell.
    """
    raise NotImplementedError


def offer(name: str) -> Callable[[type[T]], type[T]]:
    """Let cases choose the decorated shape function by ``name``."""

    def register(shape: type[T]) -> type[T]:
        SHAPES[name] = shape  # pyright: ignore[reportArgumentType]
        return shape

    return register


import_all(__name__)
