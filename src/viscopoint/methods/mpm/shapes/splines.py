"""B-splines on the nodes of the lattice (Steffen, Kirby & Berzins 2008): quadratic and cubic, between walls.

With s the distance from a node in cells, N is

    3/4 - s² within half a cell, (3/2 - |s|)² / 2 from there to 3/2 cells    (quadratic: slopes without a jump);
    2/3 - s² + |s|³/2 within a cell, (2 - |s|)³ / 6 from there to two cells    (cubic: two continuous derivatives).

**At a wall**, on a plane of nodes, a spline would mix the velocities of three planes, and holding one of them would
hold nothing. So the node beyond the wall has no motion of its own: it moves as the two planes in front of it say, on a
straight line, v_-1 = 2 v_0 - v_1, which leaves next to the wall

    N_0 = 1 - s,  N_1 = s    in half a cell (quadratic);
    N_0 = 1 - s + s³/6,  N_1 = s - s³/3,  N_2 = s³/6    in the cell (cubic: a natural spline),

and nothing else changed: the plane's nodes alone decide the velocity on the wall; constant and linear fields are kept,
and slopes stay continuous; quadratic fields are lost there. Knots repeated at the wall would keep them, but with one
function more than there are planes of nodes, centred between planes: another lattice for each place of a wall. Both
sides of the plane are treated alike, as two bodies that share its nodes: rollers above and below, and a wall in the
middle of a larger box. The wall's nodes act on points as far as 3/2 or two cells away, more than with trilinear
functions: hold them while material is there (``method.contact = "gated"``), not before.
"""

from typing import NamedTuple, Self

import numpy as np

from viscopoint.kernels.jit import implements, inline
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.shapes import NOWHERE, SHAPES, Planes, Weights, along, stencil


class Spline(NamedTuple):
    """Splines between walls on planes of nodes."""

    x0: int = NOWHERE
    x1: int = NOWHERE
    y0: int = NOWHERE
    y1: int = NOWHERE
    z0: int = NOWHERE
    z1: int = NOWHERE

    overhang = 1
    stretches = False

    @classmethod
    def fitted(cls, width: float) -> Self:
        return cls()

    def walled(self, x: Planes, y: Planes, z: Planes) -> Self:
        return type(self)(*x, *y, *z)


@SHAPES.register("quadratic")
class Quadratic(Spline):
    """Three nodes along each axis."""


@SHAPES.register("cubic")
class Cubic(Spline):
    """Four nodes along each axis."""


class QuadraticAlong(NamedTuple):
    """The same along one axis."""

    low: int
    high: int


class CubicAlong(NamedTuple):
    """The same along one axis."""

    low: int
    high: int


@implements(along, Quadratic)
def quadratic_along(shape: Quadratic, points: Points, p: int, axis: int) -> QuadraticAlong:
    return QuadraticAlong(shape[2 * axis], shape[2 * axis + 1])


@implements(along, Cubic)
def cubic_along(shape: Cubic, points: Points, p: int, axis: int) -> CubicAlong:
    return CubicAlong(shape[2 * axis], shape[2 * axis + 1])


@implements(stencil, QuadraticAlong)
@inline
def walled_quadratic(shape: QuadraticAlong, place: float) -> tuple[np.uint64, Weights, Weights]:
    middle = int(place + 0.5)  # the nearest node
    beyond = place - middle  # of the point, from there: -1/2 to 1/2
    first = np.uint64(middle - 1)
    if middle == shape.low or middle == shape.high:
        up = 1.0 if beyond >= 0.0 else 0.0
        before, after = (up - 1.0) * beyond, up * beyond
        return first, (before, 1.0 - before - after, after), (up - 1.0, 1.0 - 2.0 * up, up)
    below, above = 0.5 - beyond, 0.5 + beyond
    before, after = 0.5 * below * below, 0.5 * above * above
    return first, (before, 0.75 - beyond * beyond, after), (-below, -2.0 * beyond, above)


@implements(stencil, CubicAlong)
@inline
def walled_cubic(shape: CubicAlong, place: float) -> tuple[np.uint64, Weights, Weights]:
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


@implements(stencil, Quadratic)
def quadratic(shape: Quadratic, place: float) -> tuple[np.uint64, Weights, Weights]:
    return walled_quadratic(QuadraticAlong(NOWHERE, NOWHERE), place)


@implements(stencil, Cubic)
def cubic(shape: Cubic, place: float) -> tuple[np.uint64, Weights, Weights]:
    return walled_cubic(CubicAlong(NOWHERE, NOWHERE), place)
