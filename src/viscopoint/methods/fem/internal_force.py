"""From the nodes' motion over a step to stresses, and from these to forces: the same for all elements."""

import math
from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import PARTS, inline, kernel
from viscopoint.kernels.slabs import COLOURS, coloured_slabs_of
from viscopoint.kernels.workspace import BLOCK, load, load_tuple, store, widest_vectors, workspace
from viscopoint.materials.block import AFTER, JACOBIAN, SWEPT, MaterialCode, call_block
from viscopoint.methods.fem import cells, elements
from viscopoint.methods.fem.mesh import Slabs
from viscopoint.methods.fem.state import (
    PLACE,
    POINT_REFERENCE,
    REFERENCE,
    REST_STEP,
    STEP_LENGTH,
    VOLUME,
    WHOLE,
    Elements,
    load_motion,
)
from viscopoint.model.nodes import Nodes
from viscopoint.model.points import apply_viscosity, load_material, store_material, store_volume
from viscopoint.model.viscosity import BulkViscosity, longest_step


class Limits(NamedTuple):
    """How far the next step may go, and what happens to elements that allow no step."""

    critical: Array  # [slab], least stable step of each, ms; 0 where an element is inside out
    limiting: Indices  # [slab], the element whose it is
    delete_below: float  # an element whose step without bulk viscosity is less is deleted, ms; -1: none is


@kernel(PARTS, COLOURS)
def strain_elements(
    part: int, nodes: Nodes, rows: Elements, cell: Any, element: Any, slabs: Slabs, limits: Limits,
    material: MaterialCode, viscosity: BulkViscosity, dt: float,
) -> None:  # fmt: skip
    """Update J, σ, bulk viscosity and hourglass forces of each element; add its forces to its corners."""
    widest_vectors()  # pyright: ignore[reportCallIssue]  (an intrinsic)
    work = workspace(material.n_history)  # pyright: ignore[reportCallIssue]
    start, order, alive = slabs.start, slabs.order, rows.shared.alive
    points = len(rows.volume) // len(alive)
    for slab in coloured_slabs_of(start, len(start) - 1, part):
        least, where = math.inf, -1
        for first in range(start[slab], start[slab + 1], BLOCK):
            count = min(BLOCK, start[slab + 1] - first)
            for i in range(count):
                e = np.int64(order[first + i])
                load_motion(nodes, rows, e, cell, work, i)
                elements.load_own(element, rows, e, work, i)
                reference = 0.0
                for k in range(points):
                    reference += rows.volume[e * points + k]
                store(work, REFERENCE, i, reference)
            for i in range(count):
                elements.dilate(element, work, i, cell, dt)
            for k in range(points):
                for i in range(count):
                    q = np.int64(order[first + i]) * points + k
                    load_material(rows.material, q, work, i, material.n_history)
                    store(work, POINT_REFERENCE, i, rows.volume[q])
                for i in range(count):
                    elements.strain(element, work, i, k, cell, dt)
                call_block(material.update, work, count, material.numbers)
                for i in range(count):
                    elements.gather(element, work, i, k, cell)
                for i in range(count):
                    e = np.int64(order[first + i])
                    if alive[e] and load(work, WHOLE, i) > 0.0:
                        store_material(rows.material, e * points + k, work, i, material.n_history)
            for i in range(count):
                respond(element, work, i, cell, material, viscosity, dt)
            for i in range(count):
                e = np.int64(order[first + i])
                if not alive[e]:
                    continue
                if load(work, WHOLE, i) > 0.0:
                    store_volume(rows.shared, e, work, i)
                    elements.store_own(element, rows, e, work, i)
                least, where = finish(nodes, rows, e, cell, limits, work, i, least, where)
        limits.critical[slab], limits.limiting[slab] = least, where


@inline
def respond(
    element: Any, work: Any, i: int, cell: Any, material: MaterialCode, viscosity: BulkViscosity, dt: float
) -> None:
    """Find bulk viscosity, stable step and corner forces of the block's element i."""
    place, now, swept = elements.load_modes(work, PLACE, i, cell), load(work, VOLUME, i), load(work, SWEPT, i)
    gradient, half = cells.volume_gradient(place), 0.5 * swept
    length = cells.smallest_length(place, gradient, now)
    swept_before, swept_after = half * load(work, JACOBIAN, i), half * load(work, AFTER, i)
    sound, damping = apply_viscosity(work, i, material, viscosity, length, swept / dt, swept_before, swept_after)
    stable = elements.stable_length(element, work, i, place, gradient)
    store(work, REST_STEP, i, stable / sound)
    store(work, STEP_LENGTH, i, longest_step(viscosity, stable, length, sound, damping))
    on = elements.modal_forces(element, work, i, cell, place, gradient, material, sound, length, dt)
    store(work, PLACE, i, cells.corner_forces(on))


@inline
def finish(
    nodes: Nodes, rows: Elements, e: int, cell: Any, limits: Limits, work: Any, i: int, least: float, where: int
) -> tuple[float, int]:
    """Delete element e if it allows no step, else add its forces; return the least step, and whose it is."""
    shared = rows.shared
    if not load(work, WHOLE, i) > 0.0:
        shared.alive[e] = limits.delete_below < 0.0  # turned inside out
        return (0.0, e) if shared.alive[e] and least > 0.0 else (least, where)
    if load(work, REST_STEP, i) < limits.delete_below:
        shared.alive[e] = 0
        return least, where
    add_forces(nodes.force, rows.corner[e], cell, work, i)
    step = load(work, STEP_LENGTH, i)
    return (step, e) if step < least else (least, where)


@inline
def add_forces(force: Array, corner: Any, cell: Any, work: Any, i: int) -> None:
    """Add the corners' forces to those of the nodes ``force[n, 3]``."""
    forces = load_tuple(work, PLACE, i, cells.corner_numbers(cell))
    for k in range(len(forces) // 3):
        n = corner[k]
        force[n, 0] += forces[3 * k]
        force[n, 1] += forces[3 * k + 1]
        force[n, 2] += forces[3 * k + 2]
