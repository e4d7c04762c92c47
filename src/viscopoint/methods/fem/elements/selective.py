"""The selectively reduced element: points like corners for shear, one mean dilatation (B-bar; Hughes 1980)."""

import math
from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.jit import PARTS, inline, kernel
from viscopoint.kernels.slabs import COLOURS, coloured_slabs_of
from viscopoint.kernels.tensors import deviator, matrix, sym_columns, trace
from viscopoint.kernels.workspace import (
    BLOCK,
    add,
    load,
    load_sym,
    load_tuple,
    store,
    widest_vectors,
    workspace,
)
from viscopoint.materials.block import AFTER, GRADIENT, JACOBIAN, STRESS, SWEPT, MaterialCode, call_block
from viscopoint.methods.fem import cells
from viscopoint.methods.fem.elements import ELEMENTS, Limits, finish
from viscopoint.methods.fem.mesh import Slabs
from viscopoint.methods.fem.state import (
    DET,
    FLOW,
    MEAN,
    ON,
    PLACE,
    REFERENCE,
    REST_STEP,
    SHARPEST,
    STEP_LENGTH,
    VOLUME,
    WEIGHTS,
    WHOLE,
    Elements,
    load_motion,
)
from viscopoint.model.nodes import Nodes
from viscopoint.model.points import VISCOUS, apply_viscosity, load_material, store_material, store_volume
from viscopoint.model.viscosity import BulkViscosity, longest_step


@ELEMENTS.register("selective")
class Selective(NamedTuple):
    """An integration point for each corner; nothing to control."""

    @classmethod
    def controlled(cls, hourglass: Any) -> "Selective":
        return cls()

    @property
    def full(self) -> bool:
        return True

    @property
    def hourglass_modes(self) -> bool:
        return False

    def internal_force(
        self, nodes: Nodes, elements: Elements, cell: Any, slabs: Slabs, limits: Limits, material: MaterialCode,
        viscosity: BulkViscosity, dt: float,
    ) -> None:  # fmt: skip
        """Take the nodes' motion over the step to stresses, and add the elements' forces to the nodes."""
        strain_selective(nodes, elements, cell, slabs, limits, material, viscosity, dt)


@kernel(PARTS, COLOURS)
def strain_selective(
    part: int, nodes: Nodes, elements: Elements, cell: Any, slabs: Slabs, limits: Limits, material: MaterialCode,
    viscosity: BulkViscosity, dt: float,
) -> None:  # fmt: skip
    """Update J and bulk viscosity of each element, σ of its points; add its forces to its corners."""
    widest_vectors()  # pyright: ignore[reportCallIssue]  (an intrinsic)
    work = workspace(material.n_history)  # pyright: ignore[reportCallIssue]
    start, order, alive = slabs.start, slabs.order, elements.shared.alive
    points = elements.corner.shape[1]
    for slab in coloured_slabs_of(start, len(start) - 1, part):
        least, where = math.inf, -1
        for first in range(start[slab], start[slab + 1], BLOCK):
            count = min(BLOCK, start[slab + 1] - first)
            for i in range(count):
                e = np.int64(order[first + i])
                load_motion(nodes, elements, e, cell, work, i)
                reference = 0.0
                for k in range(points):
                    reference += elements.volume[e * points + k]
                store(work, REFERENCE, i, reference)
            for i in range(count):
                dilate(work, i, cell, dt)
            for k in range(points):
                for i in range(count):
                    q = np.int64(order[first + i]) * points + k
                    load_material(elements.material, q, work, i, material.n_history)
                for i in range(count):
                    strain(work, i, k, cell, dt)
                call_block(material.update, work, count, material.numbers)
                for i in range(count):
                    gather(work, i, k, cell)
                for i in range(count):
                    e = np.int64(order[first + i])
                    if alive[e] and load(work, WHOLE, i) > 0.0:
                        store_material(elements.material, e * points + k, work, i, material.n_history)
            for i in range(count):
                respond(work, i, cell, material, viscosity, dt)
            for i in range(count):
                e = np.int64(order[first + i])
                if not alive[e]:
                    continue
                if load(work, WHOLE, i) > 0.0:
                    store_volume(elements.shared, e, work, i)
                least, where = finish(nodes, elements, e, cell, limits, work, i, least, where)
        limits.critical[slab], limits.limiting[slab] = least, where


@inline
def dilate(work: Any, i: int, cell: Any, dt: float) -> None:
    """Find the motion of the block's element i by modes, its volume and its mean dilatation."""
    place = cells.modes_of(cell, load_tuple(work, PLACE, i, cells.corner_numbers(cell)))
    flow = cells.modes_of(cell, load_tuple(work, FLOW, i, cells.corner_numbers(cell)))
    middle = cells.moved(place, -0.5 * dt, flow)
    half = cells.volume_gradient(middle)
    now = cells.volume(place, cells.volume_gradient(place))
    stretch = cells.mean_gradient(flow, half, dt / cells.volume(middle, half))
    store(work, PLACE, i, cells.flattened(place))
    store(work, FLOW, i, cells.flattened(flow))
    store(work, ON, i, cells.flattened(cells.no_force(cell)))
    store(work, VOLUME, i, now)
    store(work, WHOLE, i, min(now, 1.0))
    store(work, AFTER, i, now / load(work, REFERENCE, i))
    store(work, SWEPT, i, stretch.x.x + stretch.y.y + stretch.z.z)
    store(work, MEAN, i, 0.0)
    store(work, SHARPEST, i, 0.0)


@inline
def strain(work: Any, i: int, k: int, cell: Any, dt: float) -> None:
    """Take the motion of the block's element i over the step to the gradient at its point k."""
    place = cells.unflattened(cell, load_tuple(work, PLACE, i, cells.mode_numbers(cell)))
    flow = cells.unflattened(cell, load_tuple(work, FLOW, i, cells.mode_numbers(cell)))
    stretch, mid_det, weights, det = cells.at_point(place, flow, dt, k)
    # what the points before one that is turned inside out have taken stays in the account
    store(work, WHOLE, i, min(load(work, WHOLE, i), min(det, mid_det)))
    store(work, GRADIENT, i, matrix(stretch))
    store(work, WEIGHTS, i, cells.point_numbers(weights))
    store(work, DET, i, det)
    store(work, SHARPEST, i, cells.sharpest(place, load(work, SHARPEST, i), weights, det))


@inline
def gather(work: Any, i: int, k: int, cell: Any) -> None:
    """Add the forces of the deviator at point k to those on the modes, and its mean stress to the element's."""
    stress = load_sym(work, STRESS, i)
    weights = cells.point_weights(cell, load_tuple(work, WEIGHTS, i, cells.weight_numbers(cell)))
    on = cells.unflattened(cell, load_tuple(work, ON, i, cells.mode_numbers(cell)))
    pull = sym_columns((-1.0) * deviator(stress))
    store(work, ON, i, cells.flattened(cells.add_point_force(on, weights, pull, k)))
    add(work, MEAN, i, load(work, DET, i) * trace(stress) / 3.0)


@inline
def respond(work: Any, i: int, cell: Any, material: MaterialCode, viscosity: BulkViscosity, dt: float) -> None:
    """Find bulk viscosity, stable step and corner forces of the block's element i."""
    place = cells.unflattened(cell, load_tuple(work, PLACE, i, cells.mode_numbers(cell)))
    on = cells.unflattened(cell, load_tuple(work, ON, i, cells.mode_numbers(cell)))
    now, swept, gradient = load(work, VOLUME, i), load(work, SWEPT, i), cells.volume_gradient(place)
    length, half = cells.smallest_length(place, gradient, now), 0.5 * swept
    swept_before, swept_after = half * load(work, JACOBIAN, i), half * load(work, AFTER, i)
    sound, damping = apply_viscosity(work, i, material, viscosity, length, swept / dt, swept_before, swept_after)
    stable = cells.selective_length(place, gradient, now, load(work, SHARPEST, i))
    store(work, REST_STEP, i, stable / sound)
    store(work, STEP_LENGTH, i, longest_step(viscosity, stable, length, sound, damping))
    pressure = load(work, VISCOUS, i) - load(work, MEAN, i) / now
    store(work, PLACE, i, cells.corner_forces(cells.add_pressure(on, gradient, pressure)))
