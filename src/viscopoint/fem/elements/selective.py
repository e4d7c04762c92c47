"""The selectively reduced hexahedron: 2 x 2 x 2 points for shear, one mean dilatation (B-bar; Hughes 1980)."""

import math
from typing import Any, NamedTuple

from numba import prange

from viscopoint.fem.elements import Limits, offer
from viscopoint.fem.hexahedron import (
    ETA,
    GAUSS,
    XI,
    ZETA,
    Modes,
    areas,
    gathered,
    local_gradient,
    mean_gradient,
    modes,
    moved,
    no_modes,
    slopes,
    smallest_length,
    spread,
    stable_length,
    volume,
    volume_gradient,
)
from viscopoint.fem.mesh import Slabs
from viscopoint.fem.state import Elements, Nodes
from viscopoint.jit import kernel
from viscopoint.kinematics import strain_and_turn
from viscopoint.laws import History, hypoelastic_work, update_stress
from viscopoint.rows import load, store
from viscopoint.tensors import deviator, dot, matrix, read, spherical, sym_columns, trace, write
from viscopoint.viscosity import BulkViscosity, longest_step, viscous_pressure


@offer("selective")
class Selective(NamedTuple):
    """Eight integration points; nothing to control."""

    @classmethod
    def controlled(cls, hourglass: Any) -> "Selective":
        return cls()

    @property
    def points(self) -> int:
        return 8

    @property
    def memory(self) -> int:
        return 0

    def answer(
        self, nodes: Nodes, elements: Elements, slabs: Slabs, limits: Limits, law: Any, factors: Any, blank: History,
        sound: float, viscosity: BulkViscosity, dt: float,
    ) -> None:  # fmt: skip
        """Take the nodes' motion over the step to stresses, and add the elements' forces to the nodes."""
        strain_selective(nodes, elements, slabs, limits, law, factors, blank, sound, viscosity, dt)


@kernel
def strain_selective(
    nodes: Nodes, elements: Elements, slabs: Slabs, limits: Limits, law: Any, factors: Any, blank: History,
    sound: float, viscosity: BulkViscosity, dt: float,
) -> None:  # fmt: skip
    """Update J and bulk viscosity of each element, σ of its points; spread its forces to its corners."""
    alive, jacobian, viscous = elements.alive, elements.jacobian, elements.viscous_pressure
    dissipated, hypoelastic, viscous_loss = elements.dissipated, elements.hypoelastic, elements.viscous_loss
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
                half, reach = volume_gradient(middle), volume_gradient(place)
                now = volume(place, reach)
                reference = 0.0
                for k in range(8):
                    reference += elements.volume[e, k]
                before, after = float(jacobian[e]), now / reference
                growth = after - before
                stretch = mean_gradient(flow, half, dt / volume(middle, half))
                swelling = stretch.x.x + stretch.y.y + stretch.z.z
                on, mean, sharpest, whole = no_modes(), 0.0, 0.0, now > 0.0
                for k in range(8):
                    xi, eta, zeta = GAUSS * XI[k], GAUSS * ETA[k], GAUSS * ZETA[k]
                    mid_faces, mid_det = areas(slopes(middle, xi, eta, zeta))
                    faces, det = areas(slopes(place, xi, eta, zeta))
                    whole = whole and det > 0.0 and mid_det > 0.0
                    if not whole:  # turned inside out; what the points before have taken stays in the account
                        break
                    gradient = local_gradient(slopes(flow, xi, eta, zeta), mid_faces, dt / mid_det)
                    strain, turn = strain_and_turn(matrix(gradient))
                    strain = deviator(strain) + spherical(swelling / 3.0)
                    earlier, memory = read(elements.stress[e, k]), load(elements.history[e, k], blank)
                    stress, history, loss = update_stress(law, factors, strain, turn, after, earlier, memory)
                    write(elements.stress[e, k], stress)
                    store(elements.history[e, k], history)
                    dissipated[e, k] += 0.5 * (before + after) * loss
                    hypoelastic[e, k] += hypoelastic_work(law, growth, earlier, memory, stress, history)
                    mean += det * trace(stress) / 3.0
                    pull = -0.125 * deviator(stress)
                    on = gathered(on, sym_columns(pull), faces, xi, eta, zeta)
                    area = dot(faces.xi, faces.xi) + dot(faces.eta, faces.eta) + dot(faces.zeta, faces.zeta)
                    sharpest = max(sharpest, area / det)
                if not whole:
                    alive[e] = limits.delete_below < 0.0
                    if alive[e] and least > 0.0:
                        least, where = 0.0, e
                    continue
                jacobian[e] = after
                length, here = smallest_length(reach, now), sound * math.sqrt(after)
                pressure, damping = viscous_pressure(viscosity, law.density / after, length, here, swelling / dt)
                viscous_loss[e] -= 0.5 * reference * swelling * (before * viscous[e] + after * pressure)
                viscous[e] = pressure
                # shear at eight points: 2G Σ det |ε|² <= 2G · 8 max(area/det) of the modes' squares (see stable_length)
                stable = min(stable_length(reach, now), 2.0 * math.sqrt(now / (8.0 * sharpest)))
                if stable / here < limits.delete_below:
                    alive[e] = 0
                    continue
                step = longest_step(viscosity, stable, length, here, damping)
                if step < least:
                    least, where = step, e
                mean = -0.125 * (mean / now - pressure)
                spread(nodes.force, corner, Modes(
                    on.xi + mean * reach.xi,
                    on.eta + mean * reach.eta,
                    on.zeta + mean * reach.zeta,
                    on.eta_zeta + mean * reach.eta_zeta,
                    on.zeta_xi + mean * reach.zeta_xi,
                    on.xi_eta + mean * reach.xi_eta,
                    on.all,
                ))  # fmt: skip
            critical[slab], weakest[slab] = least, where
