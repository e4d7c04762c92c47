"""Kernels on each material point: deformation, stress, and the force that it leaves at the nodes."""

import math
from typing import Any

from viscopoint.kernels import tensors
from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import PARTS, inline, kernel
from viscopoint.kernels.kinematics import volumetric
from viscopoint.kernels.rows import read_row, write_row
from viscopoint.kernels.slabs import COLOURS, chunk, coloured_slabs_of
from viscopoint.kernels.tensors import added, cofactor, determinant, deviator, on_areas, spherical, square, trace
from viscopoint.kernels.workspace import NINE, columns, load, load_matrix, load_sym, load_tuple, store, workspace
from viscopoint.materials.block import AFTER, GRADIENT, STRESS, SWEPT, MaterialCode, call_block
from viscopoint.methods.mpm.stencil import interpolate
from viscopoint.methods.tlmpm.interpolation import move_and_deform, scatter_stress
from viscopoint.methods.tlmpm.lattice import Lattice, cells_in_block, stencil_at
from viscopoint.methods.tlmpm.points import Points
from viscopoint.methods.tlmpm.volumes import DETERMINANT, MID_JACOBIAN, SHARED, VOLUME, share
from viscopoint.model.points import (
    VISCOUS,
    apply_viscosity,
    load_material,
    load_volume,
    store_material,
    store_volume,
)
from viscopoint.model.viscosity import BulkViscosity, longest_step

(
    STEP,  # F_n+1 - F_n; then the force on the areas, -V_p P_p
    DEFORMATION,  # F
    OWN_SWEPT,  # tr Δε of the point alone
    STEP_LENGTH,  # the longest stable step
    _,
) = columns(9, 9, 1, 1, first=SHARED)


@kernel(PARTS, COLOURS)
def strain_points(
    part: int, points: Points, lattice: Lattice, shape: Any, material: MaterialCode, viscosity: BulkViscosity,
    volume: Any, stable_length: float, critical: Array, dt: float,
) -> None:  # fmt: skip
    """Take the nodes' motion over the step to F_p, J_p, σ_p and x_p, and add f_i = -Σ V_p P_p ∇0 N to the nodes.

    ``volume`` is one of ``tlmpm.volumes`` and ``stable_length`` as in ``tlmpm.stability``.
    """
    work = workspace(material.n_history)  # pyright: ignore[reportCallIssue]  (an intrinsic)
    order, cells, start = lattice.order, lattice.cells, lattice.start
    for slab in coloured_slabs_of(start, len(start) - 1, part):
        least, cell = math.inf, start[slab]
        while cell < start[slab + 1]:  # a block of whole cells
            last = cells_in_block(lattice, cell, start[slab + 1])
            first: int = cells[cell]
            count: int = cells[last] - first
            for i in range(count):
                p: int = order[first + i]
                at = stencil_at(points, p, lattice, shape)
                store(work, STEP, i, move_and_deform(points, p, lattice, lattice.velocity, at, dt))
                store(work, DEFORMATION, i, read_row(points.deformation[p], NINE))
                store(work, VOLUME, i, points.volume[p])
                load_material(points.material, p, work, i, material.n_history)
                load_volume(points.shared, p, work, i)
            for i in range(count):
                strain(work, i)
            share(volume, work, lattice, cell, last)
            call_block(material.update, work, count, material.numbers)
            for i in range(count):
                respond(work, i, lattice, material, viscosity, stable_length, dt)
            for i in range(count):
                p: int = order[first + i]
                write_row(points.deformation[p], load_tuple(work, DEFORMATION, i, NINE))
                if load(work, DETERMINANT, i) > 0.0 and load(work, MID_JACOBIAN, i) > 0.0:
                    store_material(points.material, p, work, i, material.n_history)
                    store_volume(points.shared, p, work, i)
                    scatter_stress(
                        lattice.force, lattice, stencil_at(points, p, lattice, shape), load_matrix(work, STEP, i)
                    )
                    least = min(least, load(work, STEP_LENGTH, i))
                elif load(work, VOLUME, i) > 0.0:
                    least = 0.0  # turned inside out: no step is short enough. Tracers may be
            cell = last
        critical[slab] = least


@inline
def strain(work: Any, i: int) -> None:
    """Find F at the end of the step, and the displacement gradient at mid-step, of point i of the block."""
    step, before = load_matrix(work, STEP, i), load_matrix(work, DEFORMATION, i)
    middle, now = added(before, 0.5, step), added(before, 1.0, step)
    det_middle, det_now = determinant(middle), determinant(now)
    gradient = tensors.times_transposed(1.0 / det_middle, step, cofactor(middle))
    store(work, GRADIENT, i, gradient)
    store(work, DEFORMATION, i, now)
    store(work, SWEPT, i, volumetric(gradient))
    store(work, OWN_SWEPT, i, volumetric(gradient))
    store(work, MID_JACOBIAN, i, det_middle)
    store(work, DETERMINANT, i, det_now)
    store(work, AFTER, i, det_now)


@inline
def respond(
    work: Any, i: int, lattice: Lattice, material: MaterialCode, viscosity: BulkViscosity, stable_length: float,
    dt: float,
) -> None:  # fmt: skip
    """Find bulk viscosity, stable step and the force on the nodes of point i of the block.

    With cof F = J F⁻ᵀ, P = J σ F⁻ᵀ = σ cof F. Where points share a dilatation, the material's J̄ is not det F: then the
    deviator S, whose work the material counts per J̄, pulls with J̄ S F⁻ᵀ and the pressure with p cof F.
    """
    now, det_now, stress = load_matrix(work, DEFORMATION, i), load(work, DETERMINANT, i), load_sym(work, STRESS, i)
    areas = cofactor(now)
    inverse = square(1.0 / det_now, areas)  # C⁻¹
    x, y, z = lattice.per_x, lattice.per_y, lattice.per_z
    length = 1.0 / math.sqrt(max(x * x * inverse.xx, max(y * y * inverse.yy, z * z * inverse.zz)))
    swept = 0.5 * load(work, MID_JACOBIAN, i) * load(work, OWN_SWEPT, i)
    rate = load(work, SWEPT, i) / dt
    sound, damping = apply_viscosity(work, i, material, viscosity, length, rate, swept, swept)

    pressure, size = load(work, VISCOUS, i), load(work, VOLUME, i)
    pull = (load(work, AFTER, i) / det_now) * deviator(stress) + spherical(trace(stress) / 3.0 - pressure)
    store(work, STEP, i, on_areas((-size) * pull, areas))
    stable = longest_step(viscosity, stable_length / math.sqrt(tensors.steepest(inverse)), length, sound, damping)
    store(work, STEP_LENGTH, i, stable if size > 0.0 else math.inf)


@kernel()
def interpolate_to_points(part: int, points: Points, lattice: Lattice, shape: Any, field: Array, found: Array) -> None:
    """Read Σ N field at each point into ``found[p, 3]``."""
    for p in chunk(part, PARTS, len(found)):
        mean = interpolate(field, lattice, stencil_at(points, p, lattice, shape))
        found[p, 0], found[p, 1], found[p, 2] = mean.x, mean.y, mean.z
