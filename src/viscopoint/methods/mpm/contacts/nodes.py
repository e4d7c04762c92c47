"""Nodes of the wall's plane are held as soon as they carry mass: the paper's.

Material then feels the wall before it is there, from as far away as shape functions reach.
"""

from typing import Any, NamedTuple

import numpy as np

from viscopoint.interactions.planes import Plane
from viscopoint.kernels.jit import implements
from viscopoint.methods.mpm.contacts import CONTACTS, closed
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points


@CONTACTS.register("nodes")
class Nodes(NamedTuple):
    """Nothing to look at."""

    stretches = False
    spares = 0

    @classmethod
    def at(cls, wall: Plane, points: Points, grid: Grid, shape: Any, half: float) -> "Nodes":
        return cls()


@implements(closed, Nodes)
def always(contact: Nodes, node: np.uint64) -> bool:
    return True
