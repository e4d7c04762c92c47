"""Quadratic B-splines (Steffen, Kirby & Berzins 2008): slopes without a jump, on the nodes of the lattice.

N(s) = 3/4 - s^2 within half a cell of the node, (3/2 - |s|)^2 / 2 from there to 3/2 cells.

**At a wall**, on a plane of nodes, a spline would mix the velocities of three planes, and holding one of them would
hold nothing. So the node beyond the wall has no motion of its own: it moves as the two planes in front of it say, on a
straight line, v_-1 = 2 v_0 - v_1, which leaves

    N_0 = 1 - s,  N_1 = s    in the half cell next to the wall, and nothing else changed:

the plane's nodes alone decide the velocity on the wall; constant and linear fields are kept, and slopes stay
continuous; quadratic fields are lost in that half cell. Knots repeated at the wall would keep them, but with one
function more than there are planes of nodes, centred between planes: another lattice for each place of a wall. Both
sides of the plane are treated alike, as two bodies that share its nodes: rollers above and below, and a wall in the
middle of a larger box. The wall's nodes act on points as far as 3/2 cells away, more than with trilinear functions:
hold them while material is there (``method.contact = "gated"``), not before.
"""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.jit import implements, inline
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.shapes import NOWHERE, SHAPES, Planes, Weights, along, stencil


@SHAPES.register("quadratic")
class Quadratic(NamedTuple):
    """Splines between walls on planes of nodes."""

    x0: int = NOWHERE
    x1: int = NOWHERE
    y0: int = NOWHERE
    y1: int = NOWHERE
    z0: int = NOWHERE
    z1: int = NOWHERE

    @classmethod
    def fitted(cls, width: float) -> "Quadratic":
        return cls()

    @property
    def overhang(self) -> int:
        return 1

    @property
    def stretches(self) -> bool:
        return False

    def walled(self, x: Planes, y: Planes, z: Planes) -> "Quadratic":
        return Quadratic(*x, *y, *z)


class QuadraticAlong(NamedTuple):
    """The same along one axis."""

    low: int
    high: int


@implements(along, Quadratic)
def between(shape: Quadratic, points: Points, p: int, axis: int) -> QuadraticAlong:
    return QuadraticAlong(shape[2 * axis], shape[2 * axis + 1])


@implements(stencil, QuadraticAlong)
@inline
def walled_spline(shape: QuadraticAlong, place: float) -> tuple[np.uint64, Weights, Weights]:
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


@implements(stencil, Quadratic)
def spline(shape: Quadratic, place: float) -> tuple[np.uint64, Weights, Weights]:
    return walled_spline(QuadraticAlong(NOWHERE, NOWHERE), place)
