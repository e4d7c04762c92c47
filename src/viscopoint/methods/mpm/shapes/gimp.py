"""Generalised interpolation (Bardenhagen & Kober 2004): points are boxes, not places.

Weights are hat functions averaged over a box around the point, of half width l along each axis. Boxes that stand side
by side fill space without gap or overlap, so that a uniform stress pulls at no node inside the body, however points and
nodes lie; and since the slopes are continuous, a point that crosses a cell's border tells nobody.

**Uniform** boxes (uGIMP) are the undeformed ones, l = spacing / 2, for good: cheap and robust, but boxes overlap where
the body is compressed and leave gaps where it is stretched; space is then filled evenly only in the mean.

**Contiguous** boxes (cpGIMP; Wallstedt & Guilkey 2008) stretch with the point, l = lambda spacing / 2 with

    lambda_a <- lambda_a (1 + dt L_aa)

for each axis a of space. Where axes of strain are those of the grid, boxes that filled space go on filling it, without
overlap under compression or gaps under tension. L_aa is what happens along the axis now, whatever turned before (the
diagonal of U would take it along the axis of the start), and a spin changes no box. A box does not turn: one that was
stretched and then turns by 90 degrees is stretched the wrong way, and shear leaves it upright. Boxes of up to two cells
touch four nodes along an axis; those of material that stretches further stay at that.
"""

from typing import NamedTuple, Self

import numpy as np

from viscopoint.kernels.jit import implements
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.shapes import SHAPES, Planes, Weights, along, stencil

WIDEST = 1.0  # of l, in cells


class Boxes(NamedTuple):
    """N = 1 - |s|, averaged over the point's box."""

    half: float  # l, half the box's width, in cells; at the start, or of one point along one axis

    overhang = 1
    stretches = False

    @classmethod
    def fitted(cls, width: float) -> Self:
        return cls(0.5 * width)

    def walled(self, x: Planes, y: Planes, z: Planes) -> Self:
        return self


@SHAPES.register("gimp")
class Gimp(Boxes):
    """Uniform boxes, of one cell at most."""


@SHAPES.register("cpgimp")
class ContiguousGimp(Boxes):
    """Boxes that stretch."""

    stretches = True


@implements(along, Gimp)
def uniform(shape: Gimp, points: Points, p: int, axis: int) -> Gimp:
    return shape


@implements(along, ContiguousGimp)
def stretched(shape: ContiguousGimp, points: Points, p: int, axis: int) -> ContiguousGimp:
    return ContiguousGimp(min(points.stretch[p, axis] * shape.half, WIDEST))


@implements(stencil, Gimp)
def three_nodes(shape: Gimp, place: float) -> tuple[np.uint64, Weights, Weights]:
    first = np.uint64(place - 0.5)  # the nearest node is the middle one of three
    beyond = place - first - 1.0  # of the point, from there: -1/2 to 1/2
    up, low_up = max(shape.half + beyond, 0.0), max(beyond - shape.half, 0.0)  # of the box, on either side of that node
    down, low_down = max(shape.half - beyond, 0.0), max(-beyond - shape.half, 0.0)
    per_width = 0.5 / shape.half
    after = 0.5 * per_width * (up + low_up) * (up - low_up)  # mean of s over the part of the box where s > 0
    before = 0.5 * per_width * (down + low_down) * (down - low_down)
    rises, falls = per_width * (up - low_up), per_width * (down - low_down)
    return first, (before, 1.0 - before - after, after), (-falls, falls - rises, rises)


@implements(stencil, ContiguousGimp)
def four_nodes(shape: ContiguousGimp, place: float) -> tuple[np.uint64, Weights, Weights]:
    cell = int(place)
    low, high = place - cell - shape.half, place - cell + shape.half  # of the box, from the cell's first node: -1 to 2
    # the parts of the box in the cell before, in its own and in the one after; where in their cell their middles are
    before, own, after = max(-low, 0.0), min(high, 1.0) - max(low, 0.0), max(high - 1.0, 0.0)
    there, here, beyond = 1.0 - 0.5 * before, 0.5 * (min(high, 1.0) + max(low, 0.0)), 0.5 * after
    share = 0.5 / shape.half
    a = share * before * (1.0 - there)
    b = share * (before * there + own * (1.0 - here))
    c = share * (own * here + after * (1.0 - beyond))
    d = share * after * beyond
    return (
        np.uint64(cell - 1),
        (a, b, c, d),
        (-share * before, share * (before - own), share * (own - after), share * after),
    )
