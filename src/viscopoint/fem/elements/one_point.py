"""The one-point hexahedron: mean strain, and hourglass control (Flanagan & Belytschko 1981)."""

import math
from typing import Any, NamedTuple

from numba import prange

from viscopoint.fem.elements import Limits, offer
from viscopoint.fem.hexahedron import (
    Gradient,
    Hourglass,
    Modes,
    mean_gradient,
    modes,
    moved,
    smallest_length,
    spread,
    stable_length,
    volume,
    volume_gradient,
)
from viscopoint.fem.hourglass import recalled, remember, resist
from viscopoint.fem.mesh import Slabs
from viscopoint.fem.state import Elements, Nodes
from viscopoint.jit import inline, kernel
from viscopoint.kinematics import strain_and_turn
from viscopoint.laws import History, hypoelastic_work, update_stress
from viscopoint.rows import load, store
from viscopoint.tensors import Columns, Sym, applied, matrix, read, spherical, sym_columns, trace, write
from viscopoint.viscosity import BulkViscosity, longest_step, viscous_pressure


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
    alive, jacobian, viscous = elements.alive, elements.jacobian, elements.viscous_pressure
    dissipated, hypoelastic = elements.dissipated, elements.hypoelastic
    viscous_loss, hourglass_work = elements.viscous_loss, elements.hourglass_work
    critical, weakest = limits.critical, limits.weakest
    count = len(slabs.start) - 1
    for colour in range(2):
        for pair in prange((count - colour + 1) // 2):
            slab = 2 * pair + colour
            least, where = math.inf, -1
            for q in range(slabs.start[slab], slabs.start[slab + 1]):
                e = slabs.order[q]
                if not alive[e]:
                    continue
                corner = elements.corner[e]
                place, flow = modes(nodes.position, corner), modes(nodes.velocity, corner)
                middle = moved(place, -0.5 * dt, flow)
                half = volume_gradient(middle)
                mid_volume = volume(middle, half)
                reach = volume_gradient(place)  # ∂V/∂x
                now = volume(place, reach)
                if not (now > 0.0 and mid_volume > 0.0):  # turned inside out
                    alive[e] = limits.delete_below < 0.0
                    if alive[e] and least > 0.0:
                        least, where = 0.0, e
                    continue
                gradient = mean_gradient(flow, half, dt / mid_volume)
                strain, turn = strain_and_turn(matrix(gradient))
                before, after = jacobian[e], now / elements.volume[e, 0]
                earlier, memory = read(elements.stress[e, 0]), load(elements.history[e, 0], blank)
                stress, history, loss = update_stress(law, factors, strain, turn, after, earlier, memory)
                write(elements.stress[e, 0], stress)
                store(elements.history[e, 0], history)
                jacobian[e] = after
                dissipated[e, 0] += 0.5 * (before + after) * loss
                hypoelastic[e, 0] += hypoelastic_work(law, after - before, earlier, memory, stress, history)

                length, here = smallest_length(reach, now), sound * math.sqrt(after)
                rate = trace(strain) / dt
                pressure, damping = viscous_pressure(viscosity, law.density / after, length, here, rate)
                swept = elements.volume[e, 0] * trace(strain)
                viscous_loss[e] -= 0.5 * swept * (before * viscous[e] + after * pressure)
                viscous[e] = pressure

                slip = unexplained(flow, dt, gradient, middle)
                resistance = recalled(elements.memory, e)
                force, work = resist(
                    hourglass, resistance, slip, turn, dt, law.density * elements.volume[e, 0], here, length
                )
                remember(elements.memory, e, force)
                hourglass_work[e] += work

                stable = stable_length(reach, now)
                if stable / here < limits.delete_below:
                    alive[e] = 0
                    continue
                step = longest_step(viscosity, stable, length, here, damping)
                if step < least:
                    least, where = step, e
                spread(nodes.force, corner, nodal(stress - spherical(pressure), force, place, reach, now))
            critical[slab], weakest[slab] = least, where


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
        k * (d.x * h.eta_zeta + e.x * h.zeta_xi + f.x * h.xi_eta + g.x * h.all) - 0.125 * stress.x,
        k * (d.y * h.eta_zeta + e.y * h.zeta_xi + f.y * h.xi_eta + g.y * h.all) - 0.125 * stress.y,
        k * (d.z * h.eta_zeta + e.z * h.zeta_xi + f.z * h.xi_eta + g.z * h.all) - 0.125 * stress.z,
    )
    return Modes(
        applied(total, reach.xi),
        applied(total, reach.eta),
        applied(total, reach.zeta),
        applied(total, reach.eta_zeta) + 0.125 * h.eta_zeta,
        applied(total, reach.zeta_xi) + 0.125 * h.zeta_xi,
        applied(total, reach.xi_eta) + 0.125 * h.xi_eta,
        0.125 * h.all,
    )
