"""One dilatation and one pressure for all points of a cell: B-bar (Hughes 1980), with the background grid's cells.

In each step the points of a cell share the mean θ̄ of their volume ratios, and of the traces of their strain increments,
weighted by their volumes V_p at its beginning. So together they gain exactly the volume that they would have gained one
by one. What shears is untouched, and so is a uniform dilatation.

**Energy.** Σ V_p p_p θ̄ = p̄ Σ V_p θ_p over a cell, with p̄ the mean pressure by the same weights: the work that law and
bulk viscosity account for is that of nodes on which each point pushes with p̄. So it does. The points' own pressures
stay as they are: where points of different history meet in a cell, their p_p differ, and only the mean acts. (Were each
to push with its own, the works would differ by Σ V_p (p_p - p̄) θ_p: 5 % of the energy of the paper's elastic rod.)
"""

from typing import Any, NamedTuple

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import implements, kernel
from viscopoint.kernels.kinematics import at_mid_step, volume_ratio, volumetric
from viscopoint.kernels.slabs import slabs_of
from viscopoint.kernels.tensors import Sym, deviator, read, spherical, trace
from viscopoint.methods.mpm.grid import Grid, zero
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.stencil import cell_row, gradient, stencil_at
from viscopoint.methods.mpm.volumes import VOLUMES, acting_stress, dilatation


@VOLUMES.register("cell-mean")
class CellMean(NamedTuple):
    """Sums over the points of each cell, in the row of its first node."""

    sums: Array  # [n, 4], of volume [mm^3]; of tr Δε by it and growth by it, or of p_p by it

    spares = 1

    @classmethod
    def of_strain(cls, points: Points, grid: Grid, shape: Any, dt: float) -> "CellMean":
        sums = grid.spare[0]
        zero(sums)
        sum_dilatation(points, grid, shape, dt, sums)
        return cls(sums)

    @classmethod
    def of_pressure(cls, points: Points, grid: Grid) -> "CellMean":
        sums = grid.spare[0]
        zero(sums)
        sum_tension(points, grid, sums)
        return cls(sums)


# No cell is in two slabs: threads that take whole slabs share no sum.


@kernel()
def sum_dilatation(part: int, points: Points, grid: Grid, shape: Any, dt: float, sums: Array) -> None:
    """Sum over each cell V_p, V_p tr Δε_p and V_p (θ_p - 1)."""
    start = grid.start
    for slab in slabs_of(start, len(start) - 2, part):
        for q in range(start[slab], start[slab + 1]):
            p: int = grid.order[q]
            at = stencil_at(points, p, grid, shape)
            moved = gradient(grid.velocity, grid, at, dt * grid.per_cell)
            ratio = volume_ratio(moved)
            volume = points.shared.jacobian[p] * points.volume[p]
            cell = cell_row(points, p, grid)
            sums[cell, 0] += volume
            sums[cell, 1] += volume * volumetric(at_mid_step(moved))
            sums[cell, 2] += volume * (ratio - 1.0)


@kernel()
def sum_tension(part: int, points: Points, grid: Grid, sums: Array) -> None:
    """Sum over each cell V_p and -V_p p_p, bulk viscosity included."""
    start = grid.start
    for slab in slabs_of(start, len(start) - 2, part):
        for q in range(start[slab], start[slab + 1]):
            p: int = grid.order[q]
            volume = points.shared.jacobian[p] * points.volume[p]
            cell = cell_row(points, p, grid)
            sums[cell, 0] += volume
            sums[cell, 1] += volume * (trace(read(points.material.stress[p])) / 3.0 - points.shared.viscous_pressure[p])


@implements(dilatation, CellMean)
def shared_volume(
    volume: CellMean, points: Points, p: int, grid: Grid, swept: float, ratio: float
) -> tuple[float, float]:
    cell = cell_row(points, p, grid)
    whole = volume.sums[cell, 0]
    return volume.sums[cell, 1] / whole, 1.0 + volume.sums[cell, 2] / whole


@implements(acting_stress, CellMean)
def shared_pressure(volume: CellMean, points: Points, p: int, grid: Grid) -> Sym:
    cell = cell_row(points, p, grid)
    return deviator(read(points.material.stress[p])) + spherical(volume.sums[cell, 1] / volume.sums[cell, 0])
