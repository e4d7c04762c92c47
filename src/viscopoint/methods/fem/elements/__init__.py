"""Finite elements: one short file each, found by itself.

An element is a NamedTuple of its choices, offered under the name that a case uses, for hexahedra ("3d") or for rings
of quadrilateral section ("axisymmetric"); it says how many integration points it has and what it remembers, and answers
to the nodes' motion over a step.
"""

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol, TypeVar

from viscopoint.discovery import import_all
from viscopoint.kernels.arrays import Array, Indices
from viscopoint.materials import History
from viscopoint.methods.fem.mesh import Slabs
from viscopoint.methods.fem.state import Elements, Nodes
from viscopoint.model.viscosity import BulkViscosity

T = TypeVar("T")


class Limits(NamedTuple):
    """How far the next step may go, and what happens to elements that allow no step."""

    critical: Array  # [slab], least stable step of each, ms; 0 where an element is inside out
    weakest: Indices  # [slab], the element whose it is
    delete_below: float  # an element whose step without bulk viscosity is less is deleted, ms; -1: none is


class Element(Protocol):
    """What the method asks of an element."""

    @classmethod
    def controlled(cls, hourglass: Any) -> "Element":
        """Return the element with a control of its hourglass modes, if it has any to control."""
        ...

    @property
    def points(self) -> int:
        """Number of integration points."""
        ...

    @property
    def memory(self) -> int:
        """Number of hourglass modes whose forces it remembers."""
        ...

    def answer(
        self, nodes: Nodes, elements: Elements, slabs: Slabs, limits: Limits, law: Any, factors: Any, blank: History,
        sound: float, viscosity: BulkViscosity, dt: float,
    ) -> None:  # fmt: skip
        """Update stresses by the nodes' motion over the step, add the elements' forces to the nodes, fill ``limits``.

        ``factors`` are the law's for this step, ``blank`` is as long as its history and ``sound`` the wave speed at
        J = 1 [mm/ms].
        """
        ...


ELEMENTS: dict[str, dict[str, Any]] = {"3d": {}, "axisymmetric": {}}  # by geometry and name


def offer(name: str, geometry: str = "3d") -> Callable[[type[T]], type[T]]:
    """Let cases of a geometry choose the decorated element by ``name``."""

    def register(element: type[T]) -> type[T]:
        ELEMENTS[geometry][name] = element
        return element

    return register


import_all(__name__)
