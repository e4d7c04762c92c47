"""Trilinear shape functions, those of the eight-node hexahedron: the paper's."""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.jit import implements
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.shapes import SHAPES, Planes, Weights, along, stencil


@SHAPES.register("trilinear")
class Trilinear(NamedTuple):
    """N = 1 - |s| over one cell either side."""

    overhang = 0
    stretches = False

    @classmethod
    def fitted(cls, width: float) -> "Trilinear":
        return cls()

    def walled(self, x: Planes, y: Planes, z: Planes) -> "Trilinear":
        return self


# A point on a node would give no mass to its neighbour beyond, which still enters the gradient and would seem at rest.
# So no weight is zero: the neighbour of nearly no mass moves like the point, as it does for points beside the node.
LEAST = 1e-12


@implements(stencil, Trilinear)
def linear(shape: Trilinear, place: float) -> tuple[np.uint64, Weights, Weights]:
    first = np.uint64(place)
    beyond = max(place - first, LEAST)
    return first, (1.0 - beyond, beyond), (-1.0, 1.0)


@implements(along, Trilinear)
def everywhere(shape: Trilinear, points: Points, p: int, axis: int) -> Trilinear:
    return shape
