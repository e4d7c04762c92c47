"""The one-point ring of quadrilateral section: mean strain over the ring, and hourglass control."""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import prange

from viscopoint.kernels.jit import inline, kernel
from viscopoint.kernels.rows import load, store
from viscopoint.kernels.slabs import COLOURS, PARTS, part_of
from viscopoint.kernels.tensors import (
    Columns,
    Sym,
    Vec,
    applied,
    matrix,
    read,
    read_vector,
    spherical,
    trace,
    write,
    write_vector,
)
from viscopoint.materials import History, hypoelastic_work, update_stress
from viscopoint.methods.fem.elements import Limits, offer
from viscopoint.methods.fem.hourglass import alone, resist
from viscopoint.methods.fem.mesh import Slabs
from viscopoint.methods.fem.quadrilateral import (
    Modes,
    Weights,
    corner_volumes,
    gathered,
    gradient,
    modes,
    moved,
    pulling,
    ring_weights,
    shearing,
    smallest_length,
    spread,
    stable_length,
    swelling,
    volume,
)
from viscopoint.methods.fem.state import Elements, Nodes
from viscopoint.model.kinematics import strain_and_turn
from viscopoint.model.viscosity import BulkViscosity, longest_step, viscous_pressure


@offer("one-point", "axisymmetric")
class RingOnePoint(NamedTuple):
    """One integration point; the hourglass mode is left to ``hourglass``."""

    hourglass: Any

    @classmethod
    def controlled(cls, hourglass: Any) -> "RingOnePoint":
        return cls(hourglass)

    @property
    def points(self) -> int:
        return 1

    @property
    def memory(self) -> int:
        return 1

    def answer(
        self, nodes: Nodes, elements: Elements, slabs: Slabs, limits: Limits, law: Any, factors: Any, blank: History,
        sound: float, viscosity: BulkViscosity, dt: float,
    ) -> None:  # fmt: skip
        """Take the nodes' motion over the step to stresses, and add the elements' forces to the nodes."""
        strain_ring_one_point(nodes, elements, slabs, limits, law, factors, blank, self.hourglass, sound, viscosity, dt)


@kernel
def strain_ring_one_point(
    nodes: Nodes, elements: Elements, slabs: Slabs, limits: Limits, law: Any, factors: Any, blank: History,
    hourglass: Any, sound: float, viscosity: BulkViscosity, dt: float,
) -> None:  # fmt: skip
    """Update J, σ, bulk viscosity and hourglass force of each element; spread its forces to its corners."""
    alive, jacobian, viscous = elements.alive, elements.jacobian, elements.viscous_pressure
    dissipated, hypoelastic = elements.dissipated, elements.hypoelastic
    viscous_loss, hourglass_work = elements.viscous_loss, elements.hourglass_work
    critical, weakest = limits.critical, limits.weakest
    start, layers = slabs.start, len(slabs.start) - 1
    for colour in range(COLOURS):
        for part in prange(PARTS):
            for slab in part_of(start, layers, part, colour, COLOURS):
                least, where = math.inf, -1
                for q in range(start[slab], start[slab + 1]):
                    e: int = slabs.order[q]
                    if not alive[e]:
                        continue
                    corner = elements.corner[e]
                    place, flow = modes(nodes.position, corner), modes(nodes.velocity, corner)
                    middle = moved(place, -0.5 * dt, flow)
                    mid_volume, now = volume(middle), volume(place)
                    length = smallest_length(place)
                    if not (now > 0.0 and mid_volume > 0.0 and length > 0.0):  # turned inside out
                        alive[e] = limits.delete_below < 0.0
                        if alive[e] and least > 0.0:
                            least, where = 0.0, e
                        continue
                    step_gradient = gradient(flow, ring_weights(middle), dt / mid_volume)
                    strain, turn = strain_and_turn(matrix(step_gradient))
                    before, after = np.float64(jacobian[e]), now / elements.volume[e, 0]
                    earlier, memory = read(elements.stress[e, 0]), load(elements.history[e, 0], blank)
                    stress, history, loss = update_stress(law, factors, strain, turn, after, earlier, memory)
                    write(elements.stress[e, 0], stress)
                    store(elements.history[e, 0], history)
                    jacobian[e] = after
                    dissipated[e, 0] += 0.5 * (before + after) * loss
                    hypoelastic[e, 0] += hypoelastic_work(law, after - before, earlier, memory, stress, history)

                    here = sound * math.sqrt(after)
                    pressure, damping = viscous_pressure(
                        viscosity, law.density / after, length, here, trace(strain) / dt
                    )
                    swept = elements.volume[e, 0] * trace(strain)
                    viscous_loss[e] -= 0.5 * swept * (before * viscous[e] + after * pressure)
                    viscous[e] = pressure

                    # of the mode, what the mean gradient does not explain, at mid-step
                    slip = alone(dt * flow.both - applied(step_gradient, middle.both))
                    force, work = resist(
                        hourglass, alone(read_vector(elements.memory[e])), slip, turn, dt,
                        law.density * elements.volume[e, 0], here, length,
                    )  # fmt: skip
                    write_vector(elements.memory[e], force.all)
                    hourglass_work[e] += work

                    reach, shares = ring_weights(place), corner_volumes(place)
                    swell = swelling(reach, shares, corner, nodes.fixed) / now
                    shear = shearing(reach, shares, corner, nodes.fixed) / now
                    stable = stable_length(swell, shear)
                    if stable / here < limits.delete_below:
                        alive[e] = 0
                        continue
                    step = longest_step(viscosity, stable, length, here, damping)
                    if step < least:
                        least, where = step, e
                    spread(nodes.force, corner, on_modes(stress - spherical(pressure), force.all, place, reach, now))
                critical[slab], weakest[slab] = least, where


@inline
def on_modes(stress: Sym, h: Vec, place: Modes, reach: Weights, volume: float) -> Modes:
    """Return the forces on the modes: those of the stress, and that of the hourglass control.

    The power of the latter, h·q, is h·v_g - (h ⊗ g) : L; the second part acts like a stress.
    """
    g, pull, k = place.both, pulling((-1.0) * stress), 1.0 / volume
    none = Vec(0.0, 0.0, 0.0)
    total = Columns(pull.x - (k * g.x) * h, pull.y, pull.z - (k * g.z) * h)
    return gathered(Modes(none, none, none, h), total, reach)
