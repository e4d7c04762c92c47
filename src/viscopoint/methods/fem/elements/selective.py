"""The selectively reduced hexahedron: 2 x 2 x 2 points for shear, one mean dilatation (B-bar; Hughes 1980)."""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import prange

from viscopoint.kernels.jit import inline, kernel
from viscopoint.kernels.slabs import COLOURS, PARTS, part_of
from viscopoint.kernels.tensors import components, deviator, dot, matrix, read, spherical, sym_columns, trace
from viscopoint.kernels.workspace import BLOCK, HISTORY, add, keep, kept, widest_vectors, workspace
from viscopoint.materials import History, hypoelastic_work, update_stress
from viscopoint.methods.fem.block import (
    BEFORE,
    CORNERS,
    FLAT,
    FLOW,
    HYPOELASTIC,
    JACOBIAN,
    LOSS,
    MEAN,
    ON,
    PLACE,
    REFERENCE,
    REST_STEP,
    SHARPEST,
    SIX,
    STEP_LENGTH,
    STRESS,
    SWELLING,
    VISCOUS,
    VISCOUS_LOSS,
    VOLUME,
    WHOLE,
    recall_motion,
    recall_point,
    remember_point,
    remember_whole,
    spread,
)
from viscopoint.methods.fem.elements import Limits, offer
from viscopoint.methods.fem.hexahedron import (
    ETA,
    GAUSS,
    XI,
    ZETA,
    Modes,
    Slopes,
    areas,
    corner_forces,
    flattened,
    gathered,
    local_gradient,
    mean_gradient,
    modes_of,
    moved,
    slopes,
    smallest_length,
    stable_length,
    unflattened,
    volume,
    volume_gradient,
)
from viscopoint.methods.fem.mesh import Slabs
from viscopoint.methods.fem.state import Elements, Nodes
from viscopoint.model.kinematics import strain_and_turn
from viscopoint.model.viscosity import BulkViscosity, longest_step, viscous_pressure


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
                        e: int = order[first + i]
                        recall_motion(nodes, elements, e, work, i)
                        keep(work, REFERENCE, i, elements.volume[e].sum(dtype=np.float64))
                    for i in range(count):
                        swell(work, i, dt)
                    for k in range(8):
                        for i in range(count):
                            recall_point(elements, order[first + i], k, work, i, blank)
                        for i in range(count):
                            answer(work, i, k, law, factors, blank, dt)
                        for i in range(count):
                            e: int = order[first + i]
                            if alive[e] and kept(work, WHOLE, i, 0.0) > 0.0:
                                remember_point(elements, e, k, work, i, blank)
                    for i in range(count):
                        push(work, i, law.density, sound, viscosity, dt)
                    for i in range(count):
                        e: int = order[first + i]
                        if not alive[e]:
                            continue
                        if not kept(work, WHOLE, i, 0.0) > 0.0:
                            alive[e] = limits.delete_below < 0.0  # turned inside out
                            if alive[e] and least > 0.0:
                                least, where = 0.0, e
                            continue
                        remember_whole(elements, e, work, i)
                        if kept(work, REST_STEP, i, 0.0) < limits.delete_below:
                            alive[e] = 0
                            continue
                        step = kept(work, STEP_LENGTH, i, 0.0)
                        if step < least:
                            least, where = step, e
                        spread(force, elements.corner[e], work, i)
                critical[slab], weakest[slab] = least, where


@inline
def swell(work: Any, i: int, dt: float) -> None:
    """Find the motion of the block's element i by modes, its volume and its mean dilatation."""
    place, flow = modes_of(kept(work, PLACE, i, CORNERS)), modes_of(kept(work, FLOW, i, CORNERS))
    middle = moved(place, -0.5 * dt, flow)
    half = volume_gradient(middle)
    now = volume(place, volume_gradient(place))
    stretch = mean_gradient(flow, half, dt / volume(middle, half))
    keep(work, PLACE, i, flattened(place))
    keep(work, FLOW, i, flattened(flow))
    keep(work, ON, i, FLAT)
    keep(work, VOLUME, i, now)
    keep(work, WHOLE, i, min(now, 1.0))
    keep(work, JACOBIAN, i, now / kept(work, REFERENCE, i, 0.0))
    keep(work, SWELLING, i, stretch.x.x + stretch.y.y + stretch.z.z)
    keep(work, MEAN, i, 0.0)
    keep(work, SHARPEST, i, 0.0)


@inline
def answer(work: Any, i: int, k: int, law: Any, factors: Any, blank: History, dt: float) -> None:
    """Take the motion of the block's element i over the step to the stress of its point k."""
    xi, eta, zeta = GAUSS * XI[k], GAUSS * ETA[k], GAUSS * ZETA[k]
    place, flow = unflattened(kept(work, PLACE, i, FLAT)), unflattened(kept(work, FLOW, i, FLAT))
    here, motion = slopes(place, xi, eta, zeta), slopes(flow, xi, eta, zeta)
    mid_faces, mid_det = areas(Slopes(
        here.xi - 0.5 * dt * motion.xi, here.eta - 0.5 * dt * motion.eta, here.zeta - 0.5 * dt * motion.zeta
    ))  # fmt: skip
    faces, det = areas(here)
    # what the points before one that is turned inside out have taken stays in the account
    keep(work, WHOLE, i, min(kept(work, WHOLE, i, 0.0), min(det, mid_det)))
    strain, turn = strain_and_turn(matrix(local_gradient(motion, mid_faces, dt / mid_det)))
    strain = deviator(strain) + spherical(kept(work, SWELLING, i, 0.0) / 3.0)
    before, after = kept(work, BEFORE, i, 0.0), kept(work, JACOBIAN, i, 0.0)
    earlier, memory = read(kept(work, STRESS, i, SIX)), kept(work, HISTORY, i, blank)
    stress, history, loss = update_stress(law, factors, strain, turn, after, earlier, memory)
    taken = hypoelastic_work(law, after - before, earlier, memory, stress, history)
    keep(work, STRESS, i, components(stress))
    keep(work, HISTORY, i, history)
    add(work, LOSS, i, 0.5 * (before + after) * loss)
    add(work, HYPOELASTIC, i, taken)
    add(work, MEAN, i, det * trace(stress) / 3.0)
    pull = sym_columns(-0.125 * deviator(stress))
    on = unflattened(kept(work, ON, i, FLAT))
    keep(work, ON, i, flattened(gathered(on, pull, faces, xi, eta, zeta)))
    area = dot(faces.xi, faces.xi) + dot(faces.eta, faces.eta) + dot(faces.zeta, faces.zeta)
    keep(work, SHARPEST, i, max(kept(work, SHARPEST, i, 0.0), area / det))


@inline
def push(work: Any, i: int, density: float, sound: float, viscosity: BulkViscosity, dt: float) -> None:
    """Find bulk viscosity, stable step and corner forces of the block's element i."""
    place, on = unflattened(kept(work, PLACE, i, FLAT)), unflattened(kept(work, ON, i, FLAT))
    before, after, now = kept(work, BEFORE, i, 0.0), kept(work, JACOBIAN, i, 0.0), kept(work, VOLUME, i, 0.0)
    swelling, reach = kept(work, SWELLING, i, 0.0), volume_gradient(place)
    length, here = smallest_length(reach, now), sound * math.sqrt(after)
    pressure, damping = viscous_pressure(viscosity, density / after, length, here, swelling / dt)
    resisted = before * kept(work, VISCOUS, i, 0.0) + after * pressure
    resisted = 0.5 * kept(work, REFERENCE, i, 0.0) * swelling * resisted
    add(work, VISCOUS_LOSS, i, -resisted)
    keep(work, VISCOUS, i, pressure)
    # shear at eight points: 2G Σ det |ε|² <= 2G · 8 max(area/det) of the modes' squares (see stable_length)
    sharpest = kept(work, SHARPEST, i, 0.0)
    stable = min(stable_length(reach, now), 2.0 * math.sqrt(now / (8.0 * sharpest)))
    keep(work, REST_STEP, i, stable / here)
    keep(work, STEP_LENGTH, i, longest_step(viscosity, stable, length, here, damping))
    mean = -0.125 * (kept(work, MEAN, i, 0.0) / now - pressure)
    keep(work, PLACE, i, corner_forces(Modes(
        on.xi + mean * reach.xi,
        on.eta + mean * reach.eta,
        on.zeta + mean * reach.zeta,
        on.eta_zeta + mean * reach.eta_zeta,
        on.zeta_xi + mean * reach.zeta_xi,
        on.xi_eta + mean * reach.xi_eta,
        on.all,
    )))  # fmt: skip
