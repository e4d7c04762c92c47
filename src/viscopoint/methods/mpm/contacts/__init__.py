"""When the rigid wall's nodes are held: one short file each, found by itself.

A choice is a NamedTuple, registered under the name that a case uses, and an implementation of ``closed``.
"""

from typing import Any, Protocol

import numpy as np

from viscopoint.discovery import Registry, import_all
from viscopoint.interactions.planes import Plane
from viscopoint.kernels.jit import generic
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points


class Contact(Protocol):
    """What the method asks of the choice beside ``closed``."""

    stretches: bool  # whether points need to know their ``stretch``
    spares: int  # how many spare arrays of nodes the choice needs

    @classmethod
    def at(cls, wall: Plane, points: Points, grid: Grid, shape: Any, half: float) -> "Contact":
        """Return what ``closed`` needs while points are where they are.

        ``half`` is half the height of a point's material at the start [mm].
        """
        ...


CONTACTS: Registry[type[Contact]] = Registry()


@generic
def closed(contact: Any, node: np.uint64) -> bool:
    """Return whether the wall acts on a node of its own plane or beyond it."""
    raise NotImplementedError


import_all(__name__)
