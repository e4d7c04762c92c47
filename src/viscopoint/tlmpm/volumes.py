"""Whose dilatation a point has: its own, or its cell's against volumetric locking (B-bar; Hughes 1980).

Points never change their cell, so that all points of a cell share one J for good, the cell's present volume over the
undeformed one, and with laws whose pressure depends on J alone one pressure: nothing else needs to be averaged.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import prange

from viscopoint.arrays import Array
from viscopoint.jit import generic, implements, kernel
from viscopoint.kinematics import strain_and_turn
from viscopoint.tensors import Sym, determinant, deviator, spherical, trace
from viscopoint.tlmpm.finite import added, cofactor, times_transposed
from viscopoint.tlmpm.interpolation import reference_gradient
from viscopoint.tlmpm.lattice import Lattice, around, cell_row
from viscopoint.tlmpm.points import Points, deformation


@generic
def dilated(volume: Any, points: Points, p: int, lattice: Lattice, strain: Sym, jacobian: float) -> tuple[Sym, float]:
    """Return the strain increment and the J at the end of the step that point p shall have.

    Args:
        volume: the choice, ``strained``.
        points: all points.
        p: the point.
        lattice: where the cells are.
        strain: the point's own strain increment.
        jacobian: its own det F at the end of the step.
    """
    raise NotImplementedError


class Local(NamedTuple):
    """Nothing is averaged."""

    @classmethod
    def strained(cls, points: Points, lattice: Lattice, shape: Any, dt: float) -> "Local":
        return cls()


@implements(dilated, Local)
def own_volume(
    volume: Local, points: Points, p: int, lattice: Lattice, strain: Sym, jacobian: float
) -> tuple[Sym, float]:
    return strain, jacobian


class CellMean(NamedTuple):
    """Sums over the points of each cell of the undeformed body, in the row of its first node."""

    sums: Array  # [n, 4], of V_p; V_p J_p and V_p J_p tr Δε_p at mid-step; V_p J_p at the end of the step [mm^3]

    @classmethod
    def strained(cls, points: Points, lattice: Lattice, shape: Any, dt: float) -> "CellMean":
        sums = np.zeros((len(lattice.velocity), 4))
        sum_dilatation(points, lattice, shape, dt, sums)
        return cls(sums)


@kernel
def sum_dilatation(points: Points, lattice: Lattice, shape: Any, dt: float, sums: Array) -> None:
    """Sum volumes over each cell; no cell is in two slabs, so that threads that take whole slabs share no sum."""
    for slab in prange(len(lattice.start) - 1):
        for q in range(lattice.start[slab], lattice.start[slab + 1]):
            p = lattice.order[q]
            volume = points.volume[p]
            if volume > 0.0:
                at = around(points, p, lattice, shape)
                step, before = reference_gradient(lattice.velocity, lattice, at, dt), deformation(points, p)
                middle = added(before, 0.5, step)
                det = determinant(middle)
                strain, _ = strain_and_turn(times_transposed(1.0 / det, step, cofactor(middle)))
                cell = cell_row(points, p, lattice)
                sums[cell, 0] += volume
                sums[cell, 1] += volume * det
                sums[cell, 2] += volume * det * trace(strain)
                sums[cell, 3] += volume * determinant(added(before, 1.0, step))


@implements(dilated, CellMean)
def shared_volume(
    volume: CellMean, points: Points, p: int, lattice: Lattice, strain: Sym, jacobian: float
) -> tuple[Sym, float]:
    row = volume.sums[cell_row(points, p, lattice)]
    if row[0] <= 0.0:  # only watched
        return strain, jacobian
    return deviator(strain) + spherical(row[2] / (3.0 * row[1])), row[3] / row[0]


VOLUMES: dict[str, type[Local] | type[CellMean]] = {"local": Local, "cell-mean": CellMean}
