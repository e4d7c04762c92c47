"""Kernels on the state of each material point: strain, stress, energies."""

import math
from typing import Any

from numba import prange

from viscopoint.arrays import Array
from viscopoint.jit import kernel
from viscopoint.kinematics import increments
from viscopoint.laws import History, hypoelastic_work, stored_energy, update_stress
from viscopoint.mpm.grid import CHUNKS, Grid
from viscopoint.mpm.points import Points
from viscopoint.mpm.support import around, gradient
from viscopoint.mpm.volumes import dilated
from viscopoint.rows import load, store
from viscopoint.tensors import read, trace, write
from viscopoint.viscosity import BulkViscosity, signal_speed, viscous_pressure


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
    jacobian, viscous, critical = points.jacobian, points.viscous_pressure, grid.critical
    dissipated, hypoelastic, viscous_loss = points.dissipated, points.hypoelastic, points.viscous_loss
    stretch, stretches = points.stretch, len(points.stretch) > 0
    scale, per_dt = dt * grid.per_cell, 1.0 / dt
    for slab in prange(len(grid.start) - 2):
        fastest = 0.0
        for q in range(grid.start[slab], grid.start[slab + 1]):
            p = grid.order[q]
            at = around(points, p, grid, shape)
            moved = gradient(grid.velocity, grid, at, scale)
            strain, turn, ratio = increments(moved)
            strain, ratio = dilated(volume, points, p, grid, strain, ratio)
            before, after = jacobian[p], jacobian[p] * ratio
            earlier, memory = read(points.stress[p]), load(points.history[p], blank)
            stress, history, loss = update_stress(law, factors, strain, turn, after, earlier, memory)
            jacobian[p] = after
            if stretches:
                stretch[p, 0] *= 1.0 + moved.xx
                stretch[p, 1] *= 1.0 + moved.yy
                stretch[p, 2] *= 1.0 + moved.zz
            write(points.stress[p], stress)
            store(points.history[p], history)
            dissipated[p] += 0.5 * (before + after) * loss
            hypoelastic[p] += hypoelastic_work(law, after - before, earlier, memory, stress, history)
            # the pressure that pushed the nodes since the stress was last updated
            viscous_loss[p] -= before * viscous[p] * trace(strain)
            rate = trace(strain) * per_dt
            here = sound * math.sqrt(after)
            pressure, damping = viscous_pressure(viscosity, law.density / after, grid.cell, here, rate)
            viscous[p] = pressure
            v = points.velocity[p]
            speed = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
            fastest = max(fastest, signal_speed(here, damping) + speed)
        critical[slab] = grid.cell / fastest


@kernel
def sum_points(points: Points, law: Any, blank: History, sums: Array) -> None:
    """Sum over each chunk of points: kinetic, stored, law-dissipated, hypoelastic, viscous energy; mass; momentum.

    They go into ``sums[chunk, 9]``, in mJ, g and g mm/ms. Points that were lost keep what they had and are in it.
    """
    total = len(points.mass)
    for chunk in prange(CHUNKS):
        row = sums[chunk]
        row[:] = 0.0
        for p in range(chunk * total // CHUNKS, (chunk + 1) * total // CHUNKS):
            m, volume, v = points.mass[p], points.volume[p], points.velocity[p]
            row[0] += 0.5 * m * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
            row[1] += volume * stored_energy(
                law, points.jacobian[p], read(points.stress[p]), load(points.history[p], blank)
            )
            row[2] += volume * points.dissipated[p]
            row[3] += volume * points.hypoelastic[p]
            row[4] += volume * points.viscous_loss[p]
            row[5] += m
            for a in range(3):
                row[6 + a] += m * v[a]
