"""The one-point element: mean strain, and hourglass control (Flanagan & Belytschko 1981)."""

import math
from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.jit import PARTS, inline, kernel
from viscopoint.kernels.kinematics import rotation_of, volumetric
from viscopoint.kernels.rows import read_row, write_row
from viscopoint.kernels.slabs import COLOURS, coloured_slabs_of
from viscopoint.kernels.tensors import (
    Columns,
    Sym,
    Vec,
    applied,
    fused,
    matrix,
    spherical,
    sym_columns,
)
from viscopoint.kernels.workspace import (
    BLOCK,
    add,
    load,
    load_matrix,
    load_sym,
    load_tuple,
    store,
    widest_vectors,
    workspace,
)
from viscopoint.materials.block import AFTER, GRADIENT, JACOBIAN, STRESS, SWEPT, MaterialCode, call_block
from viscopoint.methods.fem import cells
from viscopoint.methods.fem.cells import Hourglass
from viscopoint.methods.fem.elements import ELEMENTS, Limits, finish
from viscopoint.methods.fem.hourglass import hourglass_force, hourglass_numbers, hourglass_of_numbers
from viscopoint.methods.fem.mesh import Slabs
from viscopoint.methods.fem.state import (
    FLOW,
    HOURGLASS_WORK,
    PLACE,
    REFERENCE,
    REST_STEP,
    STEP_LENGTH,
    TWELVE,
    VOLUME,
    WEIGHTS,
    WHOLE,
    Elements,
    load_motion,
)
from viscopoint.model.nodes import Nodes
from viscopoint.model.points import VISCOUS, apply_viscosity, load_material, store_material, store_volume
from viscopoint.model.viscosity import BulkViscosity, longest_step


@ELEMENTS.register("one-point")
class OnePoint(NamedTuple):
    """One integration point; the hourglass modes are left to ``hourglass``."""

    hourglass: Any

    @classmethod
    def controlled(cls, hourglass: Any) -> "OnePoint":
        return cls(hourglass)

    @property
    def full(self) -> bool:
        return False

    @property
    def hourglass_modes(self) -> bool:
        return True

    def internal_force(
        self, nodes: Nodes, elements: Elements, cell: Any, slabs: Slabs, limits: Limits, material: MaterialCode,
        viscosity: BulkViscosity, dt: float,
    ) -> None:  # fmt: skip
        """Take the nodes' motion over the step to stresses, and add the elements' forces to the nodes."""
        strain_one_point(nodes, elements, cell, slabs, limits, material, self.hourglass, viscosity, dt)


@kernel(PARTS, COLOURS)
def strain_one_point(
    part: int, nodes: Nodes, elements: Elements, cell: Any, slabs: Slabs, limits: Limits, material: MaterialCode,
    hourglass: Any, viscosity: BulkViscosity, dt: float,
) -> None:  # fmt: skip
    """Update J, σ, bulk viscosity and hourglass forces of each element; add its forces to its corners."""
    widest_vectors()  # pyright: ignore[reportCallIssue]  (an intrinsic)
    work = workspace(material.n_history)  # pyright: ignore[reportCallIssue]
    start, order, alive = slabs.start, slabs.order, elements.shared.alive
    for slab in coloured_slabs_of(start, len(start) - 1, part):
        least, where = math.inf, -1
        for first in range(start[slab], start[slab + 1], BLOCK):
            count = min(BLOCK, start[slab + 1] - first)
            for i in range(count):
                e = np.int64(order[first + i])
                load_motion(nodes, elements, e, cell, work, i)
                load_material(elements.material, e, work, i, material.n_history)
                store(work, REFERENCE, i, elements.volume[e])
                store(work, WEIGHTS, i, read_row(elements.hourglass_force[e], TWELVE))
                store(work, HOURGLASS_WORK, i, elements.hourglass_work[e])
            for i in range(count):
                strain(work, i, cell, dt)
            call_block(material.update, work, count, material.numbers)
            for i in range(count):
                respond(work, i, cell, material, hourglass, viscosity, dt)
            for i in range(count):
                e = np.int64(order[first + i])
                if not alive[e]:
                    continue
                if load(work, WHOLE, i) > 0.0:
                    store_volume(elements.shared, e, work, i)
                    store_material(elements.material, e, work, i, material.n_history)
                    write_row(elements.hourglass_force[e], load_tuple(work, WEIGHTS, i, TWELVE))
                    elements.hourglass_work[e] = load(work, HOURGLASS_WORK, i)
                least, where = finish(nodes, elements, e, cell, limits, work, i, least, where)
        limits.critical[slab], limits.limiting[slab] = least, where


@inline
def strain(work: Any, i: int, cell: Any, dt: float) -> None:
    """Take the motion of the block's element i over the step to its mean gradient and its volume."""
    place = cells.modes_of(cell, load_tuple(work, PLACE, i, cells.corner_numbers(cell)))
    flow = cells.modes_of(cell, load_tuple(work, FLOW, i, cells.corner_numbers(cell)))
    middle = cells.moved(place, -0.5 * dt, flow)
    half, gradient = cells.volume_gradient(middle), cells.volume_gradient(place)
    mid_volume, now = cells.volume(middle, half), cells.volume(place, gradient)
    stretch = cells.mean_gradient(flow, half, dt / mid_volume)
    store(work, GRADIENT, i, matrix(stretch))
    store(work, SWEPT, i, volumetric(matrix(stretch)))
    store(work, AFTER, i, now / load(work, REFERENCE, i))
    store(work, VOLUME, i, now)
    whole = now > 0.0 and mid_volume > 0.0 and cells.smallest_length(place, gradient, now) > 0.0
    store(work, WHOLE, i, 1.0 if whole else 0.0)
    store(work, PLACE, i, cells.flattened(place))
    store(
        work, FLOW, i, hourglass_numbers(unexplained(cells.hourglass_of(flow), dt, stretch, cells.hourglass_of(middle)))
    )


@inline
def respond(
    work: Any, i: int, cell: Any, material: MaterialCode, hourglass: Any, viscosity: BulkViscosity, dt: float
) -> None:
    """Find bulk viscosity, hourglass forces, stable step and corner forces of the block's element i."""
    place, now = cells.unflattened(cell, load_tuple(work, PLACE, i, cells.mode_numbers(cell))), load(work, VOLUME, i)
    gradient, reference, swept = cells.volume_gradient(place), load(work, REFERENCE, i), load(work, SWEPT, i)
    length, half = cells.smallest_length(place, gradient, now), 0.5 * swept
    swept_before, swept_after = half * load(work, JACOBIAN, i), half * load(work, AFTER, i)
    sound, damping = apply_viscosity(work, i, material, viscosity, length, swept / dt, swept_before, swept_after)
    slip = hourglass_of_numbers(load_tuple(work, FLOW, i, TWELVE))
    before = hourglass_of_numbers(load_tuple(work, WEIGHTS, i, TWELVE))
    mass = material.density * reference
    h, taken = hourglass_force(
        hourglass, before, slip, rotation_of(load_matrix(work, GRADIENT, i)), dt, mass, sound, length
    )
    stable = cells.stable_length(place, gradient, now)
    store(work, WEIGHTS, i, hourglass_numbers(h))
    add(work, HOURGLASS_WORK, i, taken)
    store(work, REST_STEP, i, stable / sound)
    store(work, STEP_LENGTH, i, longest_step(viscosity, stable, length, sound, damping))
    pull = pulling(load_sym(work, STRESS, i) - spherical(load(work, VISCOUS, i)), h, cells.hourglass_of(place), now)
    store(work, PLACE, i, cells.corner_forces(cells.mean_forces(place, gradient, pull, h)))


@inline
def unexplained(flow: Hourglass, dt: float, gradient: Columns, place: Hourglass) -> Hourglass:
    """Return the step of the hourglass modes less what the mean gradient explains, q = Δt v_α - G x_α, at mid-step."""
    return Hourglass(
        dt * flow.eta_zeta - applied(gradient, place.eta_zeta),
        dt * flow.zeta_xi - applied(gradient, place.zeta_xi),
        dt * flow.xi_eta - applied(gradient, place.xi_eta),
        dt * flow.all - applied(gradient, place.all),
    )


@inline
def pulling(stress: Sym, h: Hourglass, place: Hourglass, volume: float) -> Columns:
    """Return what acts like a uniform stress: -σ, and a part of the hourglass control.

    The power of the latter, Σ h·q, is Σ h·v_α - (Σ h ⊗ x_α) : L with L = Σ v_m ⊗ ∂V/∂x_m / V; the second part acts
    like a stress.
    """
    d, e, f, g = place
    s, k = sym_columns(stress), -1.0 / volume
    return Columns(
        fused(_four(k * d.x, h.eta_zeta, k * e.x, h.zeta_xi, k * f.x, h.xi_eta, k * g.x, h.all), -1.0, s.x),
        fused(_four(k * d.y, h.eta_zeta, k * e.y, h.zeta_xi, k * f.y, h.xi_eta, k * g.y, h.all), -1.0, s.y),
        fused(_four(k * d.z, h.eta_zeta, k * e.z, h.zeta_xi, k * f.z, h.xi_eta, k * g.z, h.all), -1.0, s.z),
    )


@inline
def _four(a: float, x: Vec, b: float, y: Vec, c: float, z: Vec, d: float, w: Vec) -> Vec:
    """Return the sum of four products."""
    return fused(fused(fused(a * x, b, y), c, z), d, w)
