"""Generalised interpolation, uniform (uGIMP; Bardenhagen & Kober 2004): points are boxes, not places.

Weights are hat functions averaged over a box around the point, of half width l along each axis. Boxes that stand side
by side fill space without gap or overlap, so that a uniform stress pulls at no node inside the body, however points and
nodes lie; and since the slopes are continuous, a point that crosses a cell's border tells nobody.

The box is the undeformed one, l = spacing / 2, for good: cheap and robust, but boxes overlap where the body is
compressed and leave gaps where it is stretched; space is then filled evenly only in the mean.
"""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.jit import implements
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.shapes import SHAPES, Planes, Weights, along, stencil


@SHAPES.register("gimp")
class Gimp(NamedTuple):
    """N = 1 - |s|, averaged over the box."""

    half: float  # l, half the box's width, in cells: 1/2 at most

    @classmethod
    def fitted(cls, width: float) -> "Gimp":
        return cls(0.5 * width)

    @property
    def overhang(self) -> int:
        return 1

    @property
    def stretches(self) -> bool:
        return False

    def walled(self, x: Planes, y: Planes, z: Planes) -> "Gimp":
        return self


@implements(stencil, Gimp)
def averaged(shape: Gimp, place: float) -> tuple[np.uint64, Weights, Weights]:
    first = np.uint64(place - 0.5)  # the nearest node is the middle one of three
    beyond = place - first - 1.0  # of the point, from there: -1/2 to 1/2
    up, low_up = max(shape.half + beyond, 0.0), max(beyond - shape.half, 0.0)  # of the box, on either side of that node
    down, low_down = max(shape.half - beyond, 0.0), max(-beyond - shape.half, 0.0)
    per_width = 0.5 / shape.half
    after = 0.5 * per_width * (up + low_up) * (up - low_up)  # mean of s over the part of the box where s > 0
    before = 0.5 * per_width * (down + low_down) * (down - low_down)
    rises, falls = per_width * (up - low_up), per_width * (down - low_down)
    return first, (before, 1.0 - before - after, after), (-falls, falls - rises, rises)


@implements(along, Gimp)
def everywhere(shape: Gimp, points: Points, p: int, axis: int) -> Gimp:
    return shape
