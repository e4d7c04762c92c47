"""The one-point hexahedron: mean strain, and hourglass control (Flanagan & Belytschko 1981)."""

import math
from typing import Any, NamedTuple

from numba import prange

from viscopoint.kernels.jit import inline, kernel
from viscopoint.kernels.rows import load, store
from viscopoint.kernels.slabs import COLOURS, PARTS, part_of
from viscopoint.kernels.tensors import (
    Columns,
    Sym,
    Vec,
    applied,
    components,
    fused,
    matrix,
    read,
    spherical,
    sym_columns,
    trace,
)
from viscopoint.kernels.workspace import BLOCK, HISTORY, add, keep, kept, widest_vectors, workspace
from viscopoint.materials import History, hypoelastic_work, update_stress
from viscopoint.methods.fem.block import (
    BEFORE,
    CORNERS,
    FLOW,
    HOURGLASS,
    HYPOELASTIC,
    JACOBIAN,
    LOSS,
    MEMORY,
    MID_VOLUME,
    PLACE,
    REFERENCE,
    REST_STEP,
    SIX,
    STEP_LENGTH,
    STRESS,
    TWELVE,
    VISCOUS,
    VISCOUS_LOSS,
    VOLUME,
    recall_motion,
    recall_point,
    remember_point,
    remember_whole,
    spread,
)
from viscopoint.methods.fem.elements import Limits, offer
from viscopoint.methods.fem.hexahedron import (
    Gradient,
    Hourglass,
    Modes,
    corner_forces,
    mean_gradient,
    modes_of,
    moved,
    smallest_length,
    stable_length,
    volume,
    volume_gradient,
)
from viscopoint.methods.fem.hourglass import recalled, remembered, resist
from viscopoint.methods.fem.mesh import Slabs
from viscopoint.methods.fem.state import Elements, Nodes
from viscopoint.model.kinematics import strain_and_turn
from viscopoint.model.viscosity import BulkViscosity, longest_step, viscous_pressure


@offer("one-point")
class OnePoint(NamedTuple):
    """One integration point; the hourglass modes are left to ``hourglass``."""

    hourglass: Any

    @classmethod
    def controlled(cls, hourglass: Any) -> "OnePoint":
        return cls(hourglass)

    @property
    def points(self) -> int:
        return 1

    @property
    def memory(self) -> int:
        return 4

    def answer(
        self, nodes: Nodes, elements: Elements, slabs: Slabs, limits: Limits, law: Any, factors: Any, blank: History,
        sound: float, viscosity: BulkViscosity, dt: float,
    ) -> None:  # fmt: skip
        """Take the nodes' motion over the step to stresses, and add the elements' forces to the nodes."""
        strain_one_point(nodes, elements, slabs, limits, law, factors, blank, self.hourglass, sound, viscosity, dt)


@kernel
def strain_one_point(
    nodes: Nodes, elements: Elements, slabs: Slabs, limits: Limits, law: Any, factors: Any, blank: History,
    hourglass: Any, sound: float, viscosity: BulkViscosity, dt: float,
) -> None:  # fmt: skip
    """Update J, σ, bulk viscosity and hourglass forces of each element; spread its forces to its corners."""
    alive, force, order = elements.alive, nodes.force, slabs.order
    critical, weakest = limits.critical, limits.weakest
    start, layers = slabs.start, len(slabs.start) - 1
    for colour in range(COLOURS):
        for part in prange(PARTS):
            widest_vectors()  # pyright: ignore[reportCallIssue]  (an intrinsic)
            for slab in part_of(start, layers, part, colour, COLOURS):
                least, where, work = math.inf, -1, workspace(blank)
                for first in range(start[slab], start[slab + 1], BLOCK):
                    count = min(BLOCK, start[slab + 1] - first)
                    for i in range(count):
                        recall(nodes, elements, order[first + i], work, i, blank)
                    for i in range(count):
                        answer(work, i, law, factors, blank, hourglass, sound, viscosity, dt)
                    for i in range(count):
                        e: int = order[first + i]
                        if not alive[e]:
                            continue
                        if not (kept(work, VOLUME, i, 0.0) > 0.0 and kept(work, MID_VOLUME, i, 0.0) > 0.0):
                            alive[e] = limits.delete_below < 0.0  # turned inside out
                            if alive[e] and least > 0.0:
                                least, where = 0.0, e
                            continue
                        remember(elements, e, work, i, blank)
                        if kept(work, REST_STEP, i, 0.0) < limits.delete_below:
                            alive[e] = 0
                            continue
                        step = kept(work, STEP_LENGTH, i, 0.0)
                        if step < least:
                            least, where = step, e
                        spread(force, elements.corner[e], work, i)
                critical[slab], weakest[slab] = least, where


@inline
def recall(nodes: Nodes, elements: Elements, e: int, work: Any, i: int, blank: History) -> None:
    """Take what element e has, and its corners do, to the workspace."""
    recall_motion(nodes, elements, e, work, i)
    recall_point(elements, e, 0, work, i, blank)
    keep(work, REFERENCE, i, elements.volume[e, 0])
    keep(work, MEMORY, i, load(elements.memory[e], TWELVE))
    keep(work, HOURGLASS, i, elements.hourglass_work[e])


@inline
def remember(elements: Elements, e: int, work: Any, i: int, blank: History) -> None:
    """Give element e back what it has in the workspace."""
    remember_whole(elements, e, work, i)
    remember_point(elements, e, 0, work, i, blank)
    store(elements.memory[e], kept(work, MEMORY, i, TWELVE))
    elements.hourglass_work[e] = kept(work, HOURGLASS, i, 0.0)


@inline
def answer(
    work: Any, i: int, law: Any, factors: Any, blank: History, hourglass: Any, sound: float, viscosity: BulkViscosity,
    dt: float,
) -> None:  # fmt: skip
    """Take the motion of the block's element i over the step to its stress and its corners' forces."""
    place, flow = modes_of(kept(work, PLACE, i, CORNERS)), modes_of(kept(work, FLOW, i, CORNERS))
    middle = moved(place, -0.5 * dt, flow)
    half, reach = volume_gradient(middle), volume_gradient(place)  # ∂V/∂x
    mid_volume, now, reference = volume(middle, half), volume(place, reach), kept(work, REFERENCE, i, 0.0)
    gradient = mean_gradient(flow, half, dt / mid_volume)
    strain, turn = strain_and_turn(matrix(gradient))
    before, after = kept(work, BEFORE, i, 0.0), now / reference
    earlier, memory = read(kept(work, STRESS, i, SIX)), kept(work, HISTORY, i, blank)
    stress, history, loss = update_stress(law, factors, strain, turn, after, earlier, memory)
    taken = hypoelastic_work(law, after - before, earlier, memory, stress, history)

    length, here = smallest_length(reach, now), sound * math.sqrt(after)
    pressure, damping = viscous_pressure(viscosity, law.density / after, length, here, trace(strain) / dt)
    resisted = 0.5 * reference * trace(strain) * (before * kept(work, VISCOUS, i, 0.0) + after * pressure)
    slip, resistance = unexplained(flow, dt, gradient, middle), recalled(kept(work, MEMORY, i, TWELVE))
    force, work_done = resist(hourglass, resistance, slip, turn, dt, law.density * reference, here, length)
    stable = stable_length(reach, now)

    keep(work, VOLUME, i, now)
    keep(work, MID_VOLUME, i, mid_volume)
    keep(work, JACOBIAN, i, after)
    keep(work, STRESS, i, components(stress))
    keep(work, HISTORY, i, history)
    add(work, LOSS, i, 0.5 * (before + after) * loss)
    add(work, HYPOELASTIC, i, taken)
    keep(work, VISCOUS, i, pressure)
    add(work, VISCOUS_LOSS, i, -resisted)
    keep(work, MEMORY, i, remembered(force))
    add(work, HOURGLASS, i, work_done)
    keep(work, REST_STEP, i, stable / here)
    keep(work, STEP_LENGTH, i, longest_step(viscosity, stable, length, here, damping))
    keep(work, PLACE, i, corner_forces(nodal(stress - spherical(pressure), force, place, reach, now)))


@inline
def unexplained(flow: Modes, dt: float, gradient: Columns, place: Modes) -> Hourglass:
    """Return the step of the hourglass modes less what the mean gradient explains, q = Δt v_α - G x_α, at mid-step."""
    return Hourglass(
        dt * flow.eta_zeta - applied(gradient, place.eta_zeta),
        dt * flow.zeta_xi - applied(gradient, place.zeta_xi),
        dt * flow.xi_eta - applied(gradient, place.xi_eta),
        dt * flow.all - applied(gradient, place.all),
    )


@inline
def nodal(pull: Sym, h: Hourglass, place: Modes, reach: Gradient, volume: float) -> Modes:
    """Return an eighth of the forces on the modes: -σ ∂V/∂x, and those of the hourglass control.

    The power of the latter, Σ h·q, is Σ h·v_α - (Σ h ⊗ x_α) : L with L = Σ v_m ⊗ ∂V/∂x_m / V; the second part acts
    like a stress.
    """
    d, e, f, g = place.eta_zeta, place.zeta_xi, place.xi_eta, place.all
    stress, k = sym_columns(pull), -0.125 / volume
    total = Columns(
        fused(_four(k * d.x, h.eta_zeta, k * e.x, h.zeta_xi, k * f.x, h.xi_eta, k * g.x, h.all), -0.125, stress.x),
        fused(_four(k * d.y, h.eta_zeta, k * e.y, h.zeta_xi, k * f.y, h.xi_eta, k * g.y, h.all), -0.125, stress.y),
        fused(_four(k * d.z, h.eta_zeta, k * e.z, h.zeta_xi, k * f.z, h.xi_eta, k * g.z, h.all), -0.125, stress.z),
    )
    return Modes(
        applied(total, reach.xi),
        applied(total, reach.eta),
        applied(total, reach.zeta),
        fused(applied(total, reach.eta_zeta), 0.125, h.eta_zeta),
        fused(applied(total, reach.zeta_xi), 0.125, h.zeta_xi),
        fused(applied(total, reach.xi_eta), 0.125, h.xi_eta),
        0.125 * h.all,
    )


@inline
def _four(a: float, x: Vec, b: float, y: Vec, c: float, z: Vec, d: float, w: Vec) -> Vec:
    """Return the sum of four products."""
    return fused(fused(fused(a * x, b, y), c, z), d, w)
