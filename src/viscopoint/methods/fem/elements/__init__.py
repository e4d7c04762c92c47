"""Finite elements: one short file each, found by itself.

An element is a NamedTuple of its choices, registered under the name that a case uses, and generic over its cell
(``cells``); it says how many integration points it has, and takes the nodes' motion over a step to forces.
"""

from typing import Any, NamedTuple, Protocol

from viscopoint.discovery import Registry, import_all
from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import inline
from viscopoint.kernels.workspace import load, load_tuple
from viscopoint.materials.block import MaterialCode
from viscopoint.methods.fem.cells import corner_numbers
from viscopoint.methods.fem.mesh import Slabs
from viscopoint.methods.fem.state import PLACE, REST_STEP, STEP_LENGTH, WHOLE, Elements
from viscopoint.model.nodes import Nodes
from viscopoint.model.viscosity import BulkViscosity


class Limits(NamedTuple):
    """How far the next step may go, and what happens to elements that allow no step."""

    critical: Array  # [slab], least stable step of each, ms; 0 where an element is inside out
    limiting: Indices  # [slab], the element whose it is
    delete_below: float  # an element whose step without bulk viscosity is less is deleted, ms; -1: none is


class Element(Protocol):
    """What the method asks of an element."""

    @classmethod
    def controlled(cls, hourglass: Any) -> "Element":
        """Return the element with a control of its hourglass modes, if it has any to control."""
        ...

    @property
    def full(self) -> bool:
        """Whether it has an integration point for each corner, or one alone."""
        ...

    @property
    def hourglass_modes(self) -> bool:
        """Whether it remembers forces on hourglass modes."""
        ...

    def internal_force(
        self, nodes: Nodes, elements: Elements, cell: Any, slabs: Slabs, limits: Limits, material: MaterialCode,
        viscosity: BulkViscosity, dt: float,
    ) -> None:  # fmt: skip
        """Take the nodes' motion over the step to stresses, add the elements' forces to the nodes, fill ``limits``."""
        ...


ELEMENTS: Registry[type[Element]] = Registry()


@inline
def finish(
    nodes: Nodes, elements: Elements, e: int, cell: Any, limits: Limits, work: Any, i: int, least: float, where: int
) -> tuple[float, int]:
    """Delete element e if it allows no step, else add its forces; return the least step, and whose it is."""
    shared = elements.shared
    if not load(work, WHOLE, i) > 0.0:
        shared.alive[e] = limits.delete_below < 0.0  # turned inside out
        return (0.0, e) if shared.alive[e] and least > 0.0 else (least, where)
    if load(work, REST_STEP, i) < limits.delete_below:
        shared.alive[e] = 0
        return least, where
    add_forces(nodes.force, elements.corner[e], cell, work, i)
    step = load(work, STEP_LENGTH, i)
    return (step, e) if step < least else (least, where)


@inline
def add_forces(force: Array, corner: Any, cell: Any, work: Any, i: int) -> None:
    """Add the corners' forces to those of the nodes ``force[n, 3]``."""
    forces = load_tuple(work, PLACE, i, corner_numbers(cell))
    for k in range(len(forces) // 3):
        n = corner[k]
        force[n, 0] += forces[3 * k]
        force[n, 1] += forces[3 * k + 1]
        force[n, 2] += forces[3 * k + 2]


import_all(__name__)
