"""Cubic B-splines (Steffen, Kirby & Berzins 2008): two continuous derivatives, on the nodes of the lattice.

N(s) = 2/3 - s^2 + |s|^3 / 2 within a cell of the node, (2 - |s|)^3 / 6 from there to two cells.

**At a wall** the node beyond has no motion of its own, as with quadratic splines (see ``quadratic``, also for why):
v_-1 = 2 v_0 - v_1. In the cell next to the wall that leaves

    N_0 = 1 - s + s^3 / 6,    N_1 = s - s^3 / 3,    N_2 = s^3 / 6:

a natural spline, with the velocity of the plane's nodes on the wall, and constant and linear fields kept.
"""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.jit import implements, inline
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.shapes import NOWHERE, SHAPES, Planes, Weights, along, stencil


@SHAPES.register("cubic")
class Cubic(NamedTuple):
    """Splines between walls on planes of nodes."""

    x0: int = NOWHERE
    x1: int = NOWHERE
    y0: int = NOWHERE
    y1: int = NOWHERE
    z0: int = NOWHERE
    z1: int = NOWHERE

    @classmethod
    def fitted(cls, width: float) -> "Cubic":
        return cls()

    @property
    def overhang(self) -> int:
        return 1

    @property
    def stretches(self) -> bool:
        return False

    def walled(self, x: Planes, y: Planes, z: Planes) -> "Cubic":
        return Cubic(*x, *y, *z)


class CubicAlong(NamedTuple):
    """The same along one axis."""

    low: int
    high: int


@implements(along, Cubic)
def between(shape: Cubic, points: Points, p: int, axis: int) -> CubicAlong:
    return CubicAlong(shape[2 * axis], shape[2 * axis + 1])


@implements(stencil, CubicAlong)
@inline
def walled_spline(shape: CubicAlong, place: float) -> tuple[np.uint64, Weights, Weights]:
    cell = int(place)
    t = place - cell
    s = 1.0 - t
    a, b, c, d = s * s * s, 1.0 + 3.0 * s * (1.0 + s * t), 1.0 + 3.0 * t * (1.0 + t * s), t * t * t  # six times N
    da, db, dc, dd = -s * s, t * (3.0 * t - 4.0), s * (4.0 - 3.0 * s), t * t  # twice the slopes
    if cell == shape.low or cell == shape.high:  # what stands for the node below
        b, c, a = b + 2.0 * a, c - a, 0.0
        db, dc, da = db + 2.0 * da, dc - da, 0.0
    if cell + 1 == shape.low or cell + 1 == shape.high:  # and for the one above
        c, b, d = c + 2.0 * d, b - d, 0.0
        dc, db, dd = dc + 2.0 * dd, db - dd, 0.0
    w, h = 1.0 / 6.0, 0.5
    return np.uint64(cell - 1), (w * a, w * b, w * c, w * d), (h * da, h * db, h * dc, h * dd)


@implements(stencil, Cubic)
def spline(shape: Cubic, place: float) -> tuple[np.uint64, Weights, Weights]:
    return walled_spline(CubicAlong(NOWHERE, NOWHERE), place)
