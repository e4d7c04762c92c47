"""Axisymmetric bodies: rings of quadrilateral section, and finite element methods on them."""

from functools import partial

import bricks
import numpy as np
from bricks import Array
from numpy.typing import NDArray

from viscopoint.methods.fem.section import node_volumes, section_mesh
from viscopoint.model.body import Body

fem = partial(bricks.fem, safety=0.9)
PLANE = (0, 2)  # axes along which nodes move


def section(radius: float, length: float, columns: int, layers: int, shake: float = 0.0) -> Body:
    """Return half a rod's section of equal rectangles; inner nodes are moved at random by up to ``shake`` [mm]."""
    body = section_mesh(radius, radius * layers / columns, radius / columns)
    position: Array = body.position * [1.0, 0.0, length * columns / (radius * layers)]
    inner = ~outside(position)
    position[inner] += np.random.default_rng(7).uniform(-shake, shake, (int(inner.sum()), 3)) * [1.0, 0.0, 1.0]
    return body._replace(position=position, volume=node_volumes(position, body.cells))


def outside(position: Array) -> NDArray[np.bool_]:
    """Return which nodes stand on the axis, the mantle or the ends."""
    low, high = position.min(axis=0), position.max(axis=0)
    return ((position == low) | (position == high))[:, [0, 2]].any(axis=1)
