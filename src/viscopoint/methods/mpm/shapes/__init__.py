"""Shape functions of the background grid: one short file each, found by itself.

A shape function is a NamedTuple (of its parameters, if it has any), registered under the name that a case uses, and
implementations of ``stencil`` and ``along``. The three axes are independent: N(x, y, z) = N(x) N(y) N(z).
"""

from typing import Any, Protocol, Self

from viscopoint.discovery import Registry, import_all
from viscopoint.kernels.jit import generic
from viscopoint.methods.mpm.points import Points

Weights = tuple[float, ...]
Planes = tuple[int, int]  # counted from the grid's first node: where walls stand below and above the body
NOWHERE = -1  # the plane of a wall that is not there


class Shape(Protocol):
    """What the method asks of a shape function beside ``stencil`` and ``along``."""

    @classmethod
    def fitted(cls, width: float) -> Self:
        """Return the shape function for points that stand ``width`` cells apart at the start, at most one."""
        ...

    @property
    def overhang(self) -> int:
        """How many nodes before its own cell's first one a point may act on, along each axis."""
        ...

    @property
    def stretches(self) -> bool:
        """Whether points need to know their ``stretch``."""
        ...

    def walled(self, x: Planes, y: Planes, z: Planes) -> Self:
        """Return the shape function of a lattice with walls on these planes of nodes."""
        ...


SHAPES: Registry[type[Shape]] = Registry()


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


@generic
def along(shape: Any, points: Points, p: int, axis: int) -> Any:
    """Return the shape function, for ``stencil``, that point p has along an axis."""
    raise NotImplementedError


import_all(__name__)
