"""The selectively reduced ring: 2 x 2 points for shear, one mean dilatation of the whole ring (B-bar; Hughes 1980)."""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import prange

from viscopoint.kernels.jit import kernel
from viscopoint.kernels.rows import load, store
from viscopoint.kernels.slabs import COLOURS, PARTS, part_of
from viscopoint.kernels.tensors import deviator, matrix, read, spherical, trace, write
from viscopoint.materials import History, hypoelastic_work, update_stress
from viscopoint.methods.fem.elements import Limits, offer
from viscopoint.methods.fem.mesh import Slabs
from viscopoint.methods.fem.quadrilateral import (
    ETA,
    GAUSS,
    XI,
    corner_volumes,
    gathered,
    gradient,
    modes,
    moved,
    no_force,
    point_weights,
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


@offer("selective", "axisymmetric")
class RingSelective(NamedTuple):
    """Four integration points; nothing to control."""

    @classmethod
    def controlled(cls, hourglass: Any) -> "RingSelective":
        return cls()

    @property
    def points(self) -> int:
        return 4

    @property
    def memory(self) -> int:
        return 0

    def answer(
        self, nodes: Nodes, elements: Elements, slabs: Slabs, limits: Limits, law: Any, factors: Any, blank: History,
        sound: float, viscosity: BulkViscosity, dt: float,
    ) -> None:  # fmt: skip
        """Take the nodes' motion over the step to stresses, and add the elements' forces to the nodes."""
        strain_ring_selective(nodes, elements, slabs, limits, law, factors, blank, sound, viscosity, dt)


@kernel
def strain_ring_selective(
    nodes: Nodes, elements: Elements, slabs: Slabs, limits: Limits, law: Any, factors: Any, blank: History,
    sound: float, viscosity: BulkViscosity, dt: float,
) -> None:  # fmt: skip
    """Update J and bulk viscosity of each element, σ of its points; spread its forces to its corners."""
    alive, jacobian, viscous = elements.alive, elements.jacobian, elements.viscous_pressure
    dissipated, hypoelastic, viscous_loss = elements.dissipated, elements.hypoelastic, elements.viscous_loss
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
                    reach, shares, now = ring_weights(place), corner_volumes(place), volume(place)
                    reference = 0.0
                    for k in range(4):
                        reference += elements.volume[e, k]
                    before, after = np.float64(jacobian[e]), now / reference
                    growth = after - before
                    stretch = gradient(flow, ring_weights(middle), dt / volume(middle))
                    swelling_strain = stretch.x.x + stretch.y.y + stretch.z.z
                    on, mean, shear, whole = no_force(), 0.0, 0.0, now > 0.0
                    for k in range(4):
                        xi, eta = GAUSS * XI[k], GAUSS * ETA[k]
                        half, mid_volume = point_weights(middle, xi, eta)
                        local, share = point_weights(place, xi, eta)
                        whole = whole and share > 0.0 and mid_volume > 0.0
                        if not whole:  # turned inside out; what the points before have taken stays in the account
                            break
                        strain, turn = strain_and_turn(matrix(gradient(flow, half, dt / mid_volume)))
                        strain = deviator(strain) + spherical(swelling_strain / 3.0)
                        earlier, memory = read(elements.stress[e, k]), load(elements.history[e, k], blank)
                        stress, history, loss = update_stress(law, factors, strain, turn, after, earlier, memory)
                        write(elements.stress[e, k], stress)
                        store(elements.history[e, k], history)
                        dissipated[e, k] += 0.5 * (before + after) * loss
                        hypoelastic[e, k] += hypoelastic_work(law, growth, earlier, memory, stress, history)
                        mean += share * trace(stress) / 3.0
                        on = gathered(on, pulling((-1.0) * deviator(stress)), local)
                        shear += shearing(local, shares, corner, nodes.fixed) / share
                    if not whole:
                        alive[e] = limits.delete_below < 0.0
                        if alive[e] and least > 0.0:
                            least, where = 0.0, e
                        continue
                    jacobian[e] = after
                    length, here = smallest_length(place), sound * math.sqrt(after)
                    pressure, damping = viscous_pressure(
                        viscosity, law.density / after, length, here, swelling_strain / dt
                    )
                    viscous_loss[e] -= 0.5 * reference * swelling_strain * (before * viscous[e] + after * pressure)
                    viscous[e] = pressure
                    stable = stable_length(swelling(reach, shares, corner, nodes.fixed) / now, shear)
                    if stable / here < limits.delete_below:
                        alive[e] = 0
                        continue
                    step = longest_step(viscosity, stable, length, here, damping)
                    if step < least:
                        least, where = step, e
                    spread(nodes.force, corner, gathered(on, pulling(spherical(pressure - mean / now)), reach))
                critical[slab], weakest[slab] = least, where
