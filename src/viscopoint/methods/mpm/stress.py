"""Kernels on the state of each material point: strain, stress, energies."""

import math
from typing import Any

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import inline, kernel
from viscopoint.kernels.kinematics import at_mid_step, volume_ratio, volumetric
from viscopoint.kernels.slabs import CHUNKS, chunk, slabs_of
from viscopoint.kernels.tensors import Matrix
from viscopoint.kernels.vectors import dot, read_vector
from viscopoint.kernels.workspace import BLOCK, columns, load, load_matrix, store, workspace
from viscopoint.materials.block import AFTER, GRADIENT, JACOBIAN, SWEPT, MaterialCode, call_block
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.stencil import gradient, stencil_at
from viscopoint.methods.mpm.volumes import dilatation
from viscopoint.model.nodes import KINETIC, MASS, MOMENTUM
from viscopoint.model.points import (
    OWN,
    apply_viscosity,
    load_material,
    load_volume,
    store_material,
    store_volume,
)
from viscopoint.model.viscosity import BulkViscosity, signal_speed

SPEED, _ = columns(1, first=OWN)  # of a point in the workspace, beside what all have: v², then the signal speed


@kernel()
def update_points(
    part: int, points: Points, grid: Grid, shape: Any, material: MaterialCode, viscosity: BulkViscosity, volume: Any,
    dt: float,
) -> None:  # fmt: skip
    """Update L_p, J_p, σ_p and the bulk viscosity from the nodes' velocity, and each slab's stable step.

    ``volume`` is one of ``mpm.volumes``.
    """
    work = workspace(material.n_history)  # pyright: ignore[reportCallIssue]  (an intrinsic)
    order, start = grid.order, grid.start
    for slab in slabs_of(start, len(start) - 2, part):
        fastest = 0.0
        for first in range(start[slab], start[slab + 1], BLOCK):
            count = min(BLOCK, start[slab + 1] - first)
            for i in range(count):
                p: int = order[first + i]
                v, at = read_vector(points.velocity[p]), stencil_at(points, p, grid, shape)
                moved = gradient(grid.velocity, grid, at, dt * grid.per_cell)
                store(work, GRADIENT, i, moved)
                store(work, SPEED, i, dot(v, v))
                stretched(points, p, moved)
                load_material(points.material, p, work, i, material.n_history)
                load_volume(points.shared, p, work, i)
            for i in range(count):
                moved = load_matrix(work, GRADIENT, i)
                middle, ratio = at_mid_step(moved), volume_ratio(moved)
                swept, ratio = dilatation(volume, points, order[first + i], grid, volumetric(middle), ratio)
                store(work, GRADIENT, i, middle)
                store(work, SWEPT, i, swept)
                store(work, AFTER, i, load(work, JACOBIAN, i) * ratio)
            call_block(material.update, work, count, material.numbers)
            for i in range(count):
                respond(work, i, material, viscosity, grid.cell, dt)
            for i in range(count):
                p: int = order[first + i]
                store_material(points.material, p, work, i, material.n_history)
                store_volume(points.shared, p, work, i)
                fastest = max(fastest, load(work, SPEED, i))
        grid.critical[slab] = grid.cell / fastest


@inline
def respond(work: Any, i: int, material: MaterialCode, viscosity: BulkViscosity, cell: float, dt: float) -> None:
    """Find bulk viscosity and signal speed of point i of the block."""
    swept = load(work, SWEPT, i)
    # the pressure that pushed the nodes is the one since the stress was last updated
    swept_before, rate = load(work, JACOBIAN, i) * swept, swept / dt
    sound, damping = apply_viscosity(work, i, material, viscosity, cell, rate, swept_before, 0.0)
    store(work, SPEED, i, signal_speed(sound, damping) + math.sqrt(load(work, SPEED, i)))


@inline
def stretched(points: Points, p: int, moved: Matrix) -> None:
    """Stretch the box of point p with its material, where points have one."""
    if len(points.stretch) > 0:
        points.stretch[p, 0] *= 1.0 + moved.xx
        points.stretch[p, 1] *= 1.0 + moved.yy
        points.stretch[p, 2] *= 1.0 + moved.zz


@kernel(CHUNKS)
def sum_motion(part: int, points: Points, sums: Array) -> None:
    """Sum over each chunk of points kinetic energy, mass and momentum into ``sums[chunk, 5]``.

    Points that were lost keep what they had and are in it. Kinetic energy includes that of the affine motion around a
    point, which the transfer hands back to the nodes.
    """
    row = sums[part]
    row[:] = 0.0
    for p in chunk(part, CHUNKS, len(points.mass)):
        m, v = float(points.mass[p]), read_vector(points.velocity[p])
        row[KINETIC] += 0.5 * m * dot(v, v)
        if len(points.affine_energy) > 0:
            row[KINETIC] += m * points.affine_energy[p]
        row[MASS] += m
        row[MOMENTUM] += m * v.x
        row[MOMENTUM + 1] += m * v.y
        row[MOMENTUM + 2] += m * v.z
