"""Whose dilatation a point has: its own, or its cell's against volumetric locking (B-bar; Hughes 1980).

Points never change their cell, so that all points of a cell share one J for good, the cell's present volume over the
undeformed one, and with laws whose pressure depends on J alone one pressure: nothing else needs to be averaged.
"""

from typing import Any, NamedTuple

from viscopoint.discovery import Registry
from viscopoint.kernels.jit import generic, implements
from viscopoint.kernels.workspace import columns, load, store
from viscopoint.materials.block import AFTER, SWEPT
from viscopoint.methods.tlmpm.lattice import Lattice
from viscopoint.model.points import OWN

VOLUMES: Registry[Any] = Registry()
# V_p, det F at mid-step and at the end of the step; other columns of the method begin at ``SHARED``
VOLUME, MID_JACOBIAN, DETERMINANT, SHARED = columns(*(1,) * 3, first=OWN)


@VOLUMES.register("local")
class Local(NamedTuple):
    """Nothing is averaged."""


@VOLUMES.register("cell-mean")
class CellMean(NamedTuple):
    """Points share their cell's."""


@generic
def share(volume: Any, work: Any, lattice: Lattice, first: int, last: int) -> None:
    """Let the points of a block have the tr Δε, and J at the end of the step, that they shall have.

    Args:
        volume: the choice.
        work: the block; its points have tr Δε, mid-step and end J of their own.
        lattice: where the cells are.
        first: cell of the block's first point, in ``lattice.cells``.
        last: the cell after that of its last point.
    """
    raise NotImplementedError


@implements(share, Local)
def own(volume: Local, work: Any, lattice: Lattice, first: int, last: int) -> None:
    pass


@implements(share, CellMean)
def over_cells(volume: CellMean, work: Any, lattice: Lattice, first: int, last: int) -> None:
    start = lattice.cells[first]
    for cell in range(first, last):
        members = range(lattice.cells[cell] - start, lattice.cells[cell + 1] - start)
        whole, middle, swept, now = 0.0, 0.0, 0.0, 0.0
        for i in members:
            part = load(work, VOLUME, i)
            half = part * load(work, MID_JACOBIAN, i)
            whole += part
            middle += half
            swept += half * load(work, SWEPT, i)
            now += part * load(work, AFTER, i)
        if whole > 0.0:  # else only tracers
            for i in members:
                store(work, SWEPT, i, swept / middle)
                store(work, AFTER, i, now / whole)
