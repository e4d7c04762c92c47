"""Finite elements: one short file each, found by itself.

An element is a NamedTuple of its choices, registered under the name that a case uses, and generic over its cell
(``cells``). It says whether it has one integration point or one for each corner, and implements the operations declared
below, which take the nodes' motion over a step to forces, for the block's element i; their order is
``internal_force.strain_elements``.
"""

from typing import Any, Protocol

from viscopoint.discovery import Registry, import_all
from viscopoint.kernels.jit import generic, inline
from viscopoint.kernels.workspace import load, load_tuple, store
from viscopoint.materials.block import AFTER, MaterialCode
from viscopoint.methods.fem import cells
from viscopoint.methods.fem.state import FLOW, PLACE, REFERENCE, VOLUME, Elements


class Element(Protocol):
    """What the method asks of an element beside the operations below."""

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
        """Whether it stores forces on hourglass modes."""
        ...


ELEMENTS: Registry[type[Element]] = Registry()


@generic
def load_own(element: Any, elements: Elements, e: int, work: Any, i: int) -> None:
    """Load what element e has of its own into the workspace."""


@generic
def dilate(element: Any, work: Any, i: int, cell: Any, dt: float) -> None:
    """Find the element's volume, and what all of its points have in common of its motion."""


@generic
def strain(element: Any, work: Any, i: int, k: int, cell: Any, dt: float) -> None:
    """Find the gradient of the step at point k, for the material."""


@generic
def gather(element: Any, work: Any, i: int, k: int, cell: Any) -> None:
    """Add up what the stress at point k does."""


@generic
def stable_length(element: Any, work: Any, i: int, place: Any, gradient: Any) -> float:
    """Return l such that no frequency of the element exceeds 2c/l [mm]."""
    raise NotImplementedError


@generic
def modal_forces(
    element: Any, work: Any, i: int, cell: Any, place: Any, gradient: Any, material: MaterialCode, sound: float,
    length: float, dt: float,
) -> Any:  # fmt: skip
    """Return the forces on the modes, of stress, bulk viscosity and hourglass control."""


@generic
def store_own(element: Any, elements: Elements, e: int, work: Any, i: int) -> None:
    """Store what element e has of its own."""


@inline
def load_modes(work: Any, column: int, i: int, cell: Any) -> Any:
    """Return the field whose modes stand in the workspace."""
    return cells.unflattened(cell, load_tuple(work, column, i, cells.mode_numbers(cell)))


@inline
def find_motion(work: Any, i: int, cell: Any, dt: float) -> Any:
    """Find the element's volume.

    Returns:
        Its place, motion and place at mid-step, by modes; ∂V/∂x and the volume at mid-step; ∂V/∂x now.
    """
    place = cells.modes_of(cell, load_tuple(work, PLACE, i, cells.corner_numbers(cell)))
    flow = cells.modes_of(cell, load_tuple(work, FLOW, i, cells.corner_numbers(cell)))
    middle = cells.moved(place, -0.5 * dt, flow)
    half, gradient = cells.volume_gradient(middle), cells.volume_gradient(place)
    now = cells.volume(place, gradient)
    store(work, VOLUME, i, now)
    store(work, AFTER, i, now / load(work, REFERENCE, i))
    store(work, PLACE, i, place)
    return place, flow, middle, half, cells.volume(middle, half), gradient


import_all(__name__)
