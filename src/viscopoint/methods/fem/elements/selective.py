"""The selectively reduced element: points like corners for shear, one mean dilatation (B-bar; Hughes 1980).

The material counts energy per reference volume V of a point, at the J that all points share: a stress works on V J and
not on the point's present volume (Simo, Taylor & Pister 1985). With v the element's volume, J = v / ΣV, and D the rate
of strain that the material gets, of trace (dv/dt) / v, the power is

    Σ V J σ : D = Σ V J dev σ : D + s dv/dt,    s = Σ V tr σ / 3 ΣV,

and the force on a corner -Σ V J dev σ ∇N - s ∂v/∂x.
"""

from typing import Any, NamedTuple

from viscopoint.kernels.jit import implements
from viscopoint.kernels.tensors import deviator, matrix, sym_columns, trace
from viscopoint.kernels.workspace import add, load, load_sym, load_tuple, store
from viscopoint.materials.block import AFTER, GRADIENT, MODULUS, STRESS, SWEPT, MaterialCode
from viscopoint.methods.fem import cells, elements
from viscopoint.methods.fem.elements import load_modes
from viscopoint.methods.fem.state import (
    COUNTED,
    FLOW,
    MEAN,
    ON,
    PLACE,
    POINT_REFERENCE,
    REFERENCE,
    SHARPEST,
    STIFFEST,
    VOLUME,
    WEIGHTS,
    WHOLE,
    Elements,
)
from viscopoint.model.points import VISCOUS


@elements.ELEMENTS.register("selective")
class Selective(NamedTuple):
    """An integration point for each corner; nothing to control."""

    full = True
    hourglass_modes = False

    @classmethod
    def controlled(cls, hourglass: Any) -> "Selective":
        return cls()


@implements(elements.load_own, Selective)
@implements(elements.store_own, Selective)
def nothing(element: Selective, rows: Elements, e: int, work: Any, i: int) -> None:
    pass


@implements(elements.dilate, Selective)
def mean_dilatation(element: Selective, work: Any, i: int, cell: Any, dt: float) -> None:
    _, flow, _, half, mid_volume, _ = elements.find_motion(work, i, cell, dt)
    stretch = cells.mean_gradient(flow, half, dt / mid_volume)
    store(work, FLOW, i, cells.flattened(flow))
    store(work, ON, i, cells.flattened(cells.no_force(cell)))
    store(work, WHOLE, i, min(load(work, VOLUME, i), 1.0))
    store(work, SWEPT, i, stretch.x.x + stretch.y.y + stretch.z.z)
    store(work, MEAN, i, 0.0)
    store(work, SHARPEST, i, 0.0)
    store(work, STIFFEST, i, 0.0)


@implements(elements.strain, Selective)
def strain_point(element: Selective, work: Any, i: int, k: int, cell: Any, dt: float) -> None:
    place, flow = load_modes(work, PLACE, i, cell), load_modes(work, FLOW, i, cell)
    stretch, mid_det, weights, det = cells.at_point(place, flow, dt, k)
    # what the points before one that is turned inside out have taken stays in the account
    store(work, WHOLE, i, min(load(work, WHOLE, i), min(det, mid_det)))
    store(work, GRADIENT, i, matrix(stretch))
    store(work, WEIGHTS, i, cells.flattened(weights))
    counted = load(work, POINT_REFERENCE, i) * load(work, AFTER, i) / det
    store(work, COUNTED, i, counted)
    store(work, SHARPEST, i, cells.sharpest(place, load(work, SHARPEST, i), weights, counted / det))


@implements(elements.gather, Selective)
def gather_point(element: Selective, work: Any, i: int, k: int, cell: Any) -> None:
    """Add point k's forces of the deviator to those on the modes, and its mean stress; note the greatest modulus."""
    stress = load_sym(work, STRESS, i)
    weights = cells.point_weights(cell, load_tuple(work, WEIGHTS, i, cells.weight_numbers(cell)))
    pull = sym_columns((-load(work, COUNTED, i)) * deviator(stress))
    store(work, ON, i, cells.flattened(cells.add_point_force(load_modes(work, ON, i, cell), weights, pull, k)))
    add(work, MEAN, i, load(work, POINT_REFERENCE, i) * trace(stress) / 3.0)
    store(work, STIFFEST, i, max(load(work, STIFFEST, i), load(work, MODULUS, i)))
    store(work, MODULUS, i, load(work, STIFFEST, i))


@implements(elements.stable_length, Selective)
def of_all_points(element: Selective, work: Any, i: int, place: Any, gradient: Any) -> float:
    return cells.selective_length(place, gradient, load(work, VOLUME, i), load(work, SHARPEST, i))


@implements(elements.modal_forces, Selective)
def with_mean_pressure(
    element: Selective, work: Any, i: int, cell: Any, place: Any, gradient: Any, material: MaterialCode, sound: float,
    length: float, dt: float,
) -> Any:  # fmt: skip
    pressure = load(work, VISCOUS, i) - load(work, MEAN, i) / load(work, REFERENCE, i)
    return cells.add_pressure(load_modes(work, ON, i, cell), gradient, pressure)
