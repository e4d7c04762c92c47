"""The one-point element: mean strain, and hourglass control (Flanagan & Belytschko 1981)."""

from typing import Any, NamedTuple

from viscopoint.kernels.jit import implements, inline
from viscopoint.kernels.kinematics import rotation_of, volumetric
from viscopoint.kernels.packing import shaped
from viscopoint.kernels.rows import read_row, write_row
from viscopoint.kernels.tensors import Columns, Sym, applied, matrix, spherical, sym_columns
from viscopoint.kernels.values import fma
from viscopoint.kernels.vectors import Vec
from viscopoint.kernels.workspace import add, load, load_matrix, load_sym, load_tuple, store
from viscopoint.materials.block import GRADIENT, STRESS, SWEPT, MaterialCode
from viscopoint.methods.fem import cells, elements
from viscopoint.methods.fem.cells import Hourglass
from viscopoint.methods.fem.hourglass import hourglass_force
from viscopoint.methods.fem.state import FLOW, HOURGLASS_WORK, REFERENCE, TWELVE, VOLUME, WEIGHTS, WHOLE, Elements
from viscopoint.model.points import VISCOUS


@elements.ELEMENTS.register("one-point")
class OnePoint(NamedTuple):
    """One integration point; the hourglass modes are left to ``hourglass``."""

    hourglass: Any

    full = False
    hourglass_modes = True

    @classmethod
    def controlled(cls, hourglass: Any) -> "OnePoint":
        return cls(hourglass)


@implements(elements.load_own, OnePoint)
def load_hourglass(element: OnePoint, rows: Elements, e: int, work: Any, i: int) -> None:
    store(work, WEIGHTS, i, read_row(rows.hourglass_force[e], TWELVE))
    store(work, HOURGLASS_WORK, i, rows.hourglass_work[e])


@implements(elements.store_own, OnePoint)
def store_hourglass(element: OnePoint, rows: Elements, e: int, work: Any, i: int) -> None:
    write_row(rows.hourglass_force[e], load_tuple(work, WEIGHTS, i, TWELVE))
    rows.hourglass_work[e] = load(work, HOURGLASS_WORK, i)


@implements(elements.dilate, OnePoint)
def mean_strain(element: OnePoint, work: Any, i: int, cell: Any, dt: float) -> None:
    """Take the motion over the step to the mean gradient, and to what the hourglass modes move beside it."""
    place, flow, middle, half, mid_volume, gradient = elements.find_motion(work, i, cell, dt)
    stretch, now = cells.mean_gradient(flow, half, dt / mid_volume), load(work, VOLUME, i)
    store(work, GRADIENT, i, matrix(stretch))
    store(work, SWEPT, i, volumetric(matrix(stretch)))
    whole = now > 0.0 and mid_volume > 0.0 and cells.smallest_length(place, gradient, now) > 0.0
    store(work, WHOLE, i, 1.0 if whole else 0.0)
    motion = hourglass_motion(cells.hourglass_of(flow), dt, stretch, cells.hourglass_of(middle))
    store(work, FLOW, i, motion)


@implements(elements.strain, OnePoint)
def nothing_to_strain(element: OnePoint, work: Any, i: int, k: int, cell: Any, dt: float) -> None:
    pass


@implements(elements.gather, OnePoint)
def nothing_to_gather(element: OnePoint, work: Any, i: int, k: int, cell: Any) -> None:
    pass


@implements(elements.stable_length, OnePoint)
def of_uniform_strain(element: OnePoint, work: Any, i: int, place: Any, gradient: Any) -> float:
    return cells.stable_length(place, gradient, load(work, VOLUME, i))


@implements(elements.modal_forces, OnePoint)
def with_hourglass(
    element: OnePoint, work: Any, i: int, cell: Any, place: Any, gradient: Any, material: MaterialCode, sound: float,
    length: float, dt: float,
) -> Any:  # fmt: skip
    motion = shaped(Hourglass, load_tuple(work, FLOW, i, TWELVE))
    before = shaped(Hourglass, load_tuple(work, WEIGHTS, i, TWELVE))
    mass, rotation = material.density * load(work, REFERENCE, i), rotation_of(load_matrix(work, GRADIENT, i))
    h, taken = hourglass_force(element.hourglass, before, motion, rotation, dt, mass, sound, length)
    store(work, WEIGHTS, i, h)
    add(work, HOURGLASS_WORK, i, taken)
    stress = load_sym(work, STRESS, i) - spherical(load(work, VISCOUS, i))
    pull = modal_stress(stress, h, cells.hourglass_of(place), load(work, VOLUME, i))
    return cells.mean_forces(place, gradient, pull, h)


@inline
def hourglass_motion(flow: Hourglass, dt: float, gradient: Columns, place: Hourglass) -> Hourglass:
    """Return the step of the hourglass modes less what the mean gradient explains, q = Δt v_α - G x_α, at mid-step."""
    return Hourglass(
        dt * flow.eta_zeta - applied(gradient, place.eta_zeta),
        dt * flow.zeta_xi - applied(gradient, place.zeta_xi),
        dt * flow.xi_eta - applied(gradient, place.xi_eta),
        dt * flow.all - applied(gradient, place.all),
    )


@inline
def modal_stress(stress: Sym, h: Hourglass, place: Hourglass, volume: float) -> Columns:
    """Return what acts like a uniform stress: -σ, and a part of the hourglass control.

    The power of the latter, Σ h·q, is Σ h·v_α - (Σ h ⊗ x_α) : L with L = Σ v_m ⊗ ∂V/∂x_m / V; the second part acts
    like a stress.
    """
    d, e, f, g = place
    s, k = sym_columns(stress), -1.0 / volume
    return Columns(
        fma(-1.0, s.x, _four(k * d.x, h.eta_zeta, k * e.x, h.zeta_xi, k * f.x, h.xi_eta, k * g.x, h.all)),
        fma(-1.0, s.y, _four(k * d.y, h.eta_zeta, k * e.y, h.zeta_xi, k * f.y, h.xi_eta, k * g.y, h.all)),
        fma(-1.0, s.z, _four(k * d.z, h.eta_zeta, k * e.z, h.zeta_xi, k * f.z, h.xi_eta, k * g.z, h.all)),
    )


@inline
def _four(a: float, x: Vec, b: float, y: Vec, c: float, z: Vec, d: float, w: Vec) -> Vec:
    """Return the sum of four products."""
    return fma(d, w, fma(c, z, fma(b, y, a * x)))
