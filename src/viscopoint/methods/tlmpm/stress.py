"""Kernels on each material point: deformation, stress, and the force that it leaves at the nodes."""

import math
from typing import Any

import numpy as np
from numba import prange

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import inline, kernel
from viscopoint.kernels.rows import load
from viscopoint.kernels.slabs import COLOURS, PARTS, part_of
from viscopoint.kernels.tensors import Matrix, components, determinant, deviator, read, spherical, trace
from viscopoint.kernels.workspace import HISTORY, add, keep, kept, workspace
from viscopoint.materials import History, hypoelastic_work, stored_energy, update_stress
from viscopoint.methods.fem.state import CHUNKS
from viscopoint.methods.mpm.support import sampled
from viscopoint.methods.tlmpm.block import (
    AFTER,
    DEFORMATION,
    DETERMINANT,
    MID_JACOBIAN,
    NINE,
    STEP,
    STEP_LENGTH,
    STRAIN,
    SWELLING,
    TURN,
    VOLUME,
)
from viscopoint.methods.tlmpm.finite import added, cofactor, on_areas, square, steepest, times_transposed
from viscopoint.methods.tlmpm.interpolation import follow, push
from viscopoint.methods.tlmpm.lattice import Lattice, around, cells_in_block
from viscopoint.methods.tlmpm.points import Points, deformation, keep_deformation
from viscopoint.methods.tlmpm.volumes import share
from viscopoint.model.kinematics import strain_and_turn
from viscopoint.model.points import (
    HYPOELASTIC,
    JACOBIAN,
    LOSS,
    SIX,
    STRESS,
    VISCOUS,
    VISCOUS_LOSS,
    recall,
    remember,
)
from viscopoint.model.viscosity import BulkViscosity, longest_step, viscous_pressure


@kernel
def strain_points(
    points: Points, lattice: Lattice, shape: Any, law: Any, factors: Any, blank: History, sound: float,
    viscosity: BulkViscosity, volume: Any, reach: float, critical: Array, dt: float,
) -> None:  # fmt: skip
    """Take the nodes' motion over the step to F_p, J_p, σ_p and x_p, and add f_i = -Σ V_p P_p ∇0 N to the nodes.

    ``factors`` are the law's for this step, ``blank`` is as long as its history, ``sound`` the wave speed at J = 1
    [mm/ms], ``volume`` one of ``tlmpm.volumes`` and ``reach`` as in ``tlmpm.stability``.
    """
    order, cells, velocity, force = lattice.order, lattice.cells, lattice.velocity, lattice.force
    start, slabs = lattice.start, len(lattice.start) - 1
    for colour in range(COLOURS):
        for part in prange(PARTS):
            for slab in part_of(start, slabs, part, colour, COLOURS):
                least, cell, work = math.inf, start[slab], workspace(blank)
                while cell < start[slab + 1]:  # a block of whole cells
                    last = cells_in_block(lattice, cell, start[slab + 1])
                    first: int = cells[cell]
                    count: int = cells[last] - first
                    for i in range(count):
                        p: int = order[first + i]
                        keep(work, STEP, i, follow(points, p, lattice, velocity, around(points, p, lattice, shape), dt))
                        keep(work, DEFORMATION, i, deformation(points, p))
                        keep(work, VOLUME, i, points.volume[p])
                        recall(points, p, work, i, blank)
                    for i in range(count):
                        strain(work, i)
                    share(volume, work, lattice, cell, last)
                    for i in range(count):
                        answer(work, i, lattice, law, factors, blank, sound, viscosity, reach, dt)
                    for i in range(count):
                        p: int = order[first + i]
                        keep_deformation(points, p, Matrix(*kept(work, DEFORMATION, i, NINE)))
                        if kept(work, DETERMINANT, i, 0.0) > 0.0 and kept(work, MID_JACOBIAN, i, 0.0) > 0.0:
                            remember(points, p, work, i, blank)
                            push(force, lattice, around(points, p, lattice, shape), Matrix(*kept(work, STEP, i, NINE)))
                            least = min(least, kept(work, STEP_LENGTH, i, 0.0))
                        elif kept(work, VOLUME, i, 0.0) > 0.0:
                            least = 0.0  # turned inside out: no step is short enough. What is only watched may
                    cell = last
                critical[slab] = least


@inline
def strain(work: Any, i: int) -> None:
    """Find F at the end of the step, and strain and rotation at mid-step, of point i of the block."""
    step, before = Matrix(*kept(work, STEP, i, NINE)), Matrix(*kept(work, DEFORMATION, i, NINE))
    middle, now = added(before, 0.5, step), added(before, 1.0, step)
    det_middle, det_now = determinant(middle), determinant(now)
    increment, turn = strain_and_turn(times_transposed(1.0 / det_middle, step, cofactor(middle)))
    keep(work, DEFORMATION, i, now)
    keep(work, STRAIN, i, components(increment))
    keep(work, TURN, i, turn)
    keep(work, SWELLING, i, trace(increment))
    keep(work, MID_JACOBIAN, i, det_middle)
    keep(work, DETERMINANT, i, det_now)
    keep(work, AFTER, i, det_now)


@inline
def answer(
    work: Any, i: int, lattice: Lattice, law: Any, factors: Any, blank: History, sound: float,
    viscosity: BulkViscosity, reach: float, dt: float,
) -> None:  # fmt: skip
    """Let law and bulk viscosity answer to the strain of point i of the block.

    With cof F = J F⁻ᵀ, P = J σ F⁻ᵀ = σ cof F. Where points share a dilatation, the law's J̄ is not det F: then the
    deviator S, whose work the law counts per J̄, pulls with J̄ S F⁻ᵀ and the pressure with p cof F.
    """
    own = read(kept(work, STRAIN, i, SIX))
    swelling, after, before = kept(work, SWELLING, i, 0.0), kept(work, AFTER, i, 0.0), kept(work, JACOBIAN, i, 0.0)
    shared = deviator(own) + spherical(swelling / 3.0)
    turn, earlier = Matrix(*kept(work, TURN, i, NINE)), read(kept(work, STRESS, i, SIX))
    memory = kept(work, HISTORY, i, blank)
    stress, history, loss = update_stress(law, factors, shared, turn, after, earlier, memory)
    keep(work, STRESS, i, components(stress))
    keep(work, HISTORY, i, history)
    keep(work, JACOBIAN, i, after)
    growth = after - before
    add(work, LOSS, i, (after - 0.5 * growth) * loss)
    taken = hypoelastic_work(law, growth, earlier, memory, stress, history)
    add(work, HYPOELASTIC, i, taken)

    now, det_now = Matrix(*kept(work, DEFORMATION, i, NINE)), kept(work, DETERMINANT, i, 0.0)
    areas = cofactor(now)
    inverse = square(1.0 / det_now, areas)  # C⁻¹
    x, y, z = lattice.per_x, lattice.per_y, lattice.per_z
    length = 1.0 / math.sqrt(max(x * x * inverse.xx, max(y * y * inverse.yy, z * z * inverse.zz)))
    here = sound * math.sqrt(after)
    pressure, damping = viscous_pressure(viscosity, law.density / after, length, here, swelling / dt)
    resisted = 0.5 * kept(work, MID_JACOBIAN, i, 0.0) * trace(own) * (kept(work, VISCOUS, i, 0.0) + pressure)
    add(work, VISCOUS_LOSS, i, -resisted)
    keep(work, VISCOUS, i, pressure)

    pull = (after / det_now) * deviator(stress) + spherical(trace(stress) / 3.0 - pressure)
    size = kept(work, VOLUME, i, 0.0)
    keep(work, STEP, i, on_areas((-size) * pull, areas))
    stable = longest_step(viscosity, reach / math.sqrt(steepest(inverse)), length, here, damping)
    keep(work, STEP_LENGTH, i, stable if size > 0.0 else math.inf)


@kernel
def sum_points(points: Points, law: Any, blank: History, sums: Array) -> None:
    """Sum over each chunk of points into ``sums[chunk, 4]`` the energy stored, and lost to law and bulk viscosity.

    The fourth is what the law takes as volume changes under shear.
    """
    total = len(points.volume)
    for chunk in prange(CHUNKS):
        row = sums[chunk]
        for p in range(chunk * total // CHUNKS, (chunk + 1) * total // CHUNKS):
            volume = np.float64(points.volume[p])
            row[0] += volume * stored_energy(
                law, np.float64(points.jacobian[p]), read(points.stress[p]), load(points.history[p], blank)
            )
            row[1] += volume * points.dissipated[p]
            row[2] += volume * points.viscous_loss[p]
            row[3] += volume * points.hypoelastic[p]


@kernel
def watch(points: Points, lattice: Lattice, shape: Any, field: Array, found: Array) -> None:
    """Read Σ N field at each point into ``found[p, 3]``."""
    for p in prange(len(found)):
        mean = sampled(field, lattice, around(points, p, lattice, shape))
        found[p, 0], found[p, 1], found[p, 2] = mean.x, mean.y, mean.z
