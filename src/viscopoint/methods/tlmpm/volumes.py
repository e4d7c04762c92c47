"""Whose dilatation a point has: its own, or its cell's against volumetric locking (B-bar; Hughes 1980).

Points never change their cell, so that all points of a cell share one J for good, the cell's present volume over the
undeformed one, and with laws whose pressure depends on J alone one pressure: nothing else needs to be averaged.
"""

from typing import Any, NamedTuple

from viscopoint.kernels.jit import generic, implements
from viscopoint.kernels.workspace import keep, kept
from viscopoint.methods.tlmpm.block import AFTER, MID_JACOBIAN, SWELLING, VOLUME
from viscopoint.methods.tlmpm.lattice import Lattice


class Local(NamedTuple):
    """Nothing is averaged."""


class CellMean(NamedTuple):
    """Points share their cell's."""


@generic
def share(volume: Any, work: Any, lattice: Lattice, first: int, last: int) -> None:
    """Let the points of a block have the swelling tr Δε, and J at the end of the step, that they shall have.

    Args:
        volume: the choice.
        work: the block; its points have swelling, mid-step and end J of their own.
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
            part = kept(work, VOLUME, i, 0.0)
            half = part * kept(work, MID_JACOBIAN, i, 0.0)
            whole += part
            middle += half
            swept += half * kept(work, SWELLING, i, 0.0)
            now += part * kept(work, AFTER, i, 0.0)
        if whole > 0.0:  # else only watched
            for i in members:
                keep(work, SWELLING, i, swept / middle)
                keep(work, AFTER, i, now / whole)


VOLUMES: dict[str, type[Local] | type[CellMean]] = {"local": Local, "cell-mean": CellMean}
