"""Kernels on each material point: deformation, stress, and the force that it leaves at the nodes."""

import math
from typing import Any

from numba import prange

from viscopoint.arrays import Array
from viscopoint.fem.state import CHUNKS
from viscopoint.jit import kernel
from viscopoint.kinematics import strain_and_turn
from viscopoint.laws import History, hypoelastic_work, stored_energy, update_stress
from viscopoint.rows import load, store
from viscopoint.tensors import determinant, deviator, read, spherical, trace, write
from viscopoint.tlmpm.finite import added, cofactor, on_areas, square, steepest, times_transposed
from viscopoint.tlmpm.interpolation import mean, push, reference_gradient
from viscopoint.tlmpm.lattice import Lattice, around
from viscopoint.tlmpm.points import Points, deformation, keep_deformation
from viscopoint.tlmpm.volumes import dilated
from viscopoint.viscosity import BulkViscosity, longest_step, viscous_pressure


@kernel
def strain_points(
    points: Points, lattice: Lattice, shape: Any, law: Any, factors: Any, blank: History, sound: float,
    viscosity: BulkViscosity, volume: Any, reach: float, critical: Array, dt: float,
) -> None:  # fmt: skip
    """Take the nodes' motion over the step to F_p, J_p, σ_p and x_p, and add f_i = -Σ V_p P_p ∇0 N to the nodes.

    With cof F = J F⁻ᵀ, P = J σ F⁻ᵀ = σ cof F. Where points share a dilatation, the law's J̄ is not det F: then the
    deviator S, whose work the law counts per J̄, pulls with J̄ S F⁻ᵀ and the pressure with p cof F.

    ``factors`` are the law's for this step, ``blank`` is as long as its history, ``sound`` the wave speed at J = 1
    [mm/ms], ``volume`` one of ``tlmpm.volumes`` and ``reach`` as in ``tlmpm.stability``.
    """
    position, jacobian, viscous = points.position, points.jacobian, points.viscous_pressure
    dissipated, hypoelastic = points.dissipated, points.hypoelastic
    viscous_loss, force = points.viscous_loss, lattice.force
    x, y, z = lattice.per_x, lattice.per_y, lattice.per_z
    slabs = len(lattice.start) - 1
    for colour in range(2):
        for pair in prange((slabs - colour + 1) // 2):
            slab = 2 * pair + colour
            least = math.inf
            for q in range(lattice.start[slab], lattice.start[slab + 1]):
                p = lattice.order[q]
                at = around(points, p, lattice, shape)
                vx, vy, vz = mean(lattice.velocity, lattice, at)
                position[p, 0] += dt * vx
                position[p, 1] += dt * vy
                position[p, 2] += dt * vz
                step, before = reference_gradient(lattice.velocity, lattice, at, dt), deformation(points, p)
                middle, now = added(before, 0.5, step), added(before, 1.0, step)
                keep_deformation(points, p, now)
                det_middle, det_now = determinant(middle), determinant(now)
                if not (det_middle > 0.0 and det_now > 0.0):
                    least = 0.0  # turned inside out: no step is short enough
                    continue
                strain, turn = strain_and_turn(times_transposed(1.0 / det_middle, step, cofactor(middle)))
                swelling = trace(strain)
                strain, after = dilated(volume, points, p, lattice, strain, det_now)
                earlier, memory = read(points.stress[p]), load(points.history[p], blank)
                stress, history, loss = update_stress(law, factors, strain, turn, after, earlier, memory)
                growth, jacobian[p] = after - jacobian[p], after
                write(points.stress[p], stress)
                store(points.history[p], history)
                dissipated[p] += (after - 0.5 * growth) * loss
                hypoelastic[p] += hypoelastic_work(law, growth, earlier, memory, stress, history)
                areas = cofactor(now)
                inverse = square(1.0 / det_now, areas)  # C⁻¹
                length = 1.0 / math.sqrt(max(x * x * inverse.xx, y * y * inverse.yy, z * z * inverse.zz))
                here, rate = sound * math.sqrt(after), trace(strain) / dt
                pressure, damping = viscous_pressure(viscosity, law.density / after, length, here, rate)
                viscous_loss[p] -= 0.5 * det_middle * swelling * (viscous[p] + pressure)
                viscous[p] = pressure
                pull = (after / det_now) * deviator(stress) + spherical(trace(stress) / 3.0 - pressure)
                size = float(points.volume[p])
                push(force, lattice, at, -size, on_areas(pull, areas))
                if size > 0.0:
                    stable = reach / math.sqrt(steepest(inverse))
                    least = min(least, longest_step(viscosity, stable, length, here, damping))
            critical[slab] = least


@kernel
def sum_points(points: Points, law: Any, blank: History, sums: Array) -> None:
    """Sum over each chunk of points into ``sums[chunk, 4]`` the energy stored, and lost to law and bulk viscosity.

    The fourth is what the law takes as volume changes under shear.
    """
    total = len(points.volume)
    for chunk in prange(CHUNKS):
        row = sums[chunk]
        for p in range(chunk * total // CHUNKS, (chunk + 1) * total // CHUNKS):
            volume = points.volume[p]
            row[0] += volume * stored_energy(
                law, points.jacobian[p], read(points.stress[p]), load(points.history[p], blank)
            )
            row[1] += volume * points.dissipated[p]
            row[2] += volume * points.viscous_loss[p]
            row[3] += volume * points.hypoelastic[p]


@kernel
def watch(points: Points, lattice: Lattice, shape: Any, field: Array, found: Array) -> None:
    """Read Σ N field at each point into ``found[p, 3]``."""
    for p in prange(len(found)):
        x, y, z = mean(field, lattice, around(points, p, lattice, shape))
        found[p, 0], found[p, 1], found[p, 2] = x, y, z
