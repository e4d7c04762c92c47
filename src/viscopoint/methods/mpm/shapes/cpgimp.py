"""Generalised interpolation, contiguous (cpGIMP; Wallstedt & Guilkey 2008): boxes that deform.

As ``gimp``, but the box stretches with the point along each axis: l = lambda spacing / 2, with

    lambda_a <- lambda_a (1 + dt L_aa)

for each axis a of space. Where axes of strain are those of the grid, boxes that filled space go on filling it, without
overlap under compression or gaps under tension. L_aa is what happens along the axis now, whatever turned before (the
diagonal of U would take it along the axis of the start), and a spin changes no box. A box does not turn: one that was
stretched and then turns by 90 degrees is stretched the wrong way, and shear leaves it upright.

Boxes of up to two cells touch four nodes along an axis; those of material that stretches further stay at that.
"""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.jit import implements
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.shapes import SHAPES, Planes, Weights, along, stencil

WIDEST = 1.0  # of l, in cells


@SHAPES.register("cpgimp")
class ContiguousGimp(NamedTuple):
    """N = 1 - |s|, averaged over the point's box."""

    half: float  # l, half the box's width, in cells; at the start, or of one point along one axis

    @classmethod
    def fitted(cls, width: float) -> "ContiguousGimp":
        return cls(0.5 * width)

    @property
    def overhang(self) -> int:
        return 1

    @property
    def stretches(self) -> bool:
        return True

    def walled(self, x: Planes, y: Planes, z: Planes) -> "ContiguousGimp":
        return self


@implements(along, ContiguousGimp)
def stretched(shape: ContiguousGimp, points: Points, p: int, axis: int) -> ContiguousGimp:
    return ContiguousGimp(min(points.stretch[p, axis] * shape.half, WIDEST))


@implements(stencil, ContiguousGimp)
def averaged(shape: ContiguousGimp, place: float) -> tuple[np.uint64, Weights, Weights]:
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
