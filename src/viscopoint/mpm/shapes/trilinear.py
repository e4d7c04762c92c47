"""Trilinear shape functions, those of the eight-node hexahedron: the paper's."""

from typing import NamedTuple

import numpy as np

from viscopoint.jit import implements
from viscopoint.mpm.shapes import Weights, offer, stencil


@offer("trilinear")
class Trilinear(NamedTuple):
    """N = 1 - |s| over one cell either side."""


@implements(stencil, Trilinear)
def linear(shape: Trilinear, place: float) -> tuple[np.uint64, Weights, Weights]:
    first = np.uint64(place)
    beyond = place - first
    return first, (1.0 - beyond, beyond), (-1.0, 1.0)
