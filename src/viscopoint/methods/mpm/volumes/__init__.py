"""Whose volume and pressure a point has: one short file each, found by itself.

Nearly incompressible points that each resist their own change of volume lock: a cell has few velocities of its own, of
which every point takes one for itself. A cure is a NamedTuple, registered under the name that a case uses, and
implementations of ``dilatation`` and of its counterpart ``acting_stress``: what counts as strain must also do the work.
"""

from typing import Any, Protocol

from viscopoint.discovery import Registry, import_all
from viscopoint.kernels.jit import generic
from viscopoint.kernels.tensors import Sym
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points


class Volume(Protocol):
    """What the method asks of the choice beside ``dilatation`` and ``acting_stress``."""

    spares: int  # how many spare arrays of nodes the choice needs

    @classmethod
    def of_strain(cls, points: Points, grid: Grid, shape: Any, dt: float) -> "Volume":
        """Return what ``dilatation`` needs for the step that the nodes' velocity makes in ``dt``."""
        ...

    @classmethod
    def of_pressure(cls, points: Points, grid: Grid) -> "Volume":
        """Return what ``acting_stress`` needs of the points' pressures."""
        ...


VOLUMES: Registry[type[Volume]] = Registry()


@generic
def dilatation(volume: Any, points: Points, p: int, grid: Grid, swept: float, ratio: float) -> tuple[float, float]:
    """Return the volumetric strain and the volume ratio of a step that point p shall have.

    Args:
        volume: the choice, ``of_strain``.
        points: all points, where the step began.
        p: the point.
        grid: where the cells are.
        swept: the point's own tr Δε.
        ratio: its own det(I + A) over the step.
    """
    raise NotImplementedError


@generic
def acting_stress(volume: Any, points: Points, p: int, grid: Grid) -> Sym:
    """Return the stress, less bulk viscosity, with which point p acts on the nodes; ``volume`` is ``of_pressure``."""
    raise NotImplementedError


import_all(__name__)
