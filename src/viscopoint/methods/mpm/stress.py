"""Kernels on the state of each material point: strain, stress, energies."""

import math
from typing import Any

import numpy as np
from numba import prange

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import inline, kernel
from viscopoint.kernels.rows import load
from viscopoint.kernels.slabs import PARTS, part_of
from viscopoint.kernels.tensors import Matrix, Sym, components, read, trace
from viscopoint.kernels.workspace import BLOCK, HISTORY, add, columns, keep, kept, workspace
from viscopoint.materials import History, hypoelastic_work, stored_energy, update_stress
from viscopoint.methods.mpm.grid import CHUNKS, Grid
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.support import around, gradient
from viscopoint.methods.mpm.volumes import dilated
from viscopoint.model.kinematics import increments
from viscopoint.model.points import (
    HYPOELASTIC,
    JACOBIAN,
    LOSS,
    OWN,
    SIX,
    STRESS,
    VISCOUS,
    VISCOUS_LOSS,
    recall,
    remember,
)
from viscopoint.model.viscosity import BulkViscosity, signal_speed, viscous_pressure

# what a point has in the workspace beside what it carries
GRADIENT, SPEED, _ = columns(9, 1, first=OWN)
NINE = (0.0,) * 9


@kernel
def update_points(
    points: Points,
    grid: Grid,
    shape: Any,
    law: Any,
    factors: Any,
    blank: History,
    sound: float,
    viscosity: BulkViscosity,
    volume: Any,
    dt: float,
) -> None:
    """Update L_p, J_p, σ_p and the bulk viscosity from the nodes' velocity, and each slab's stable step.

    ``factors`` are the law's for this step, ``blank`` is as long as its history, ``sound`` the wave speed at J = 1
    [mm/ms] and ``volume`` one of ``mpm.volumes``.
    """
    order, critical, scale = grid.order, grid.critical, dt * grid.per_cell
    start, slabs = grid.start, len(grid.start) - 2
    for part in prange(PARTS):
        for slab in part_of(start, slabs, part):
            fastest, work = 0.0, workspace(blank)
            for first in range(start[slab], start[slab + 1], BLOCK):
                count = min(BLOCK, start[slab + 1] - first)
                for i in range(count):
                    p: int = order[first + i]
                    v, moved = points.velocity[p], gradient(grid.velocity, grid, around(points, p, grid, shape), scale)
                    keep(work, GRADIENT, i, moved)
                    keep(work, SPEED, i, v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
                    stretched(points, p, moved)
                    recall(points, p, work, i, blank)
                for i in range(count):
                    p: int = order[first + i]
                    strain, turn, ratio = increments(Matrix(*kept(work, GRADIENT, i, NINE)))
                    strain, ratio = dilated(volume, points, p, grid, strain, ratio)
                    answer(work, i, law, factors, blank, sound, viscosity, grid.cell, strain, turn, ratio, dt)
                for i in range(count):
                    remember(points, order[first + i], work, i, blank)
                    fastest = max(fastest, kept(work, SPEED, i, 0.0))
            critical[slab] = grid.cell / fastest


@inline
def answer(
    work: Any, i: int, law: Any, factors: Any, blank: History, sound: float, viscosity: BulkViscosity, cell: float,
    strain: Sym, turn: Matrix, ratio: float, dt: float,
) -> None:  # fmt: skip
    """Let law and bulk viscosity answer to the strain of point i of the block."""
    earlier, memory = read(kept(work, STRESS, i, SIX)), kept(work, HISTORY, i, blank)
    before = kept(work, JACOBIAN, i, 0.0)
    after = before * ratio
    stress, history, loss = update_stress(law, factors, strain, turn, after, earlier, memory)
    taken = hypoelastic_work(law, after - before, earlier, memory, stress, history)
    # the pressure that pushed the nodes since the stress was last updated
    resisted = before * kept(work, VISCOUS, i, 0.0) * trace(strain)
    here = sound * math.sqrt(after)
    pressure, damping = viscous_pressure(viscosity, law.density / after, cell, here, trace(strain) / dt)
    keep(work, STRESS, i, components(stress))
    keep(work, HISTORY, i, history)
    keep(work, JACOBIAN, i, after)
    keep(work, VISCOUS, i, pressure)
    add(work, LOSS, i, 0.5 * (before + after) * loss)
    add(work, HYPOELASTIC, i, taken)
    add(work, VISCOUS_LOSS, i, -resisted)
    keep(work, SPEED, i, signal_speed(here, damping) + math.sqrt(kept(work, SPEED, i, 0.0)))


@inline
def stretched(points: Points, p: int, moved: Matrix) -> None:
    """Stretch the box of point p with its material, where points have one."""
    if len(points.stretch) > 0:
        points.stretch[p, 0] *= 1.0 + moved.xx
        points.stretch[p, 1] *= 1.0 + moved.yy
        points.stretch[p, 2] *= 1.0 + moved.zz


@kernel
def sum_points(points: Points, law: Any, blank: History, sums: Array) -> None:
    """Sum over each chunk of points: kinetic, stored, law-dissipated, hypoelastic, viscous energy; mass; momentum.

    They go into ``sums[chunk, 9]``, in mJ, g and g mm/ms. Points that were lost keep what they had and are in it.
    Kinetic energy includes that of the affine motion around a point, which the transfer hands back to the nodes.
    """
    total = len(points.mass)
    for chunk in prange(CHUNKS):
        row = sums[chunk]
        row[:] = 0.0
        for p in range(chunk * total // CHUNKS, (chunk + 1) * total // CHUNKS):
            m, volume, v = points.mass[p], np.float64(points.volume[p]), points.velocity[p]
            row[0] += 0.5 * m * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
            if len(points.affine_energy) > 0:
                row[0] += m * points.affine_energy[p]
            row[1] += volume * stored_energy(
                law, points.jacobian[p], read(points.stress[p]), load(points.history[p], blank)
            )
            row[2] += volume * points.dissipated[p]
            row[3] += volume * points.hypoelastic[p]
            row[4] += volume * points.viscous_loss[p]
            row[5] += m
            for a in range(3):
                row[6 + a] += m * v[a]
