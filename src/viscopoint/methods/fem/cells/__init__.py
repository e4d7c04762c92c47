"""Cells of a mesh: what elements ask of their shape, and nothing of materials.

A cell describes a field over it by modes, a NamedTuple of vectors whose class says which cell it is: the field's mean
gradient comes from some, the rest are hourglass modes, which a uniform strain does not see. Forces belong to modes as
well: the force that works on a mode is the sum of the corners' forces with the mode's signs.
"""

from typing import Any, NamedTuple

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import generic, inline
from viscopoint.kernels.packing import flat
from viscopoint.kernels.tensors import Columns
from viscopoint.kernels.vectors import Vec, fma_product, product, total

Corners = tuple[float, ...]  # x, y and z at each corner


class Hourglass(NamedTuple):
    """Vectors that belong to the hourglass modes; those that a cell has not are nil."""

    eta_zeta: Vec
    zeta_xi: Vec
    xi_eta: Vec
    all: Vec  # of ξηζ, or of a quadrilateral's ξη


@generic
def corner_numbers(cell: Any) -> Corners:
    """Return as many zeros as a field has numbers at the corners."""
    raise NotImplementedError


@generic
def mode_numbers(cell: Any) -> tuple[float, ...]:
    """Return as many zeros as a field's modes have numbers."""
    raise NotImplementedError


@generic
def weight_numbers(cell: Any) -> tuple[float, ...]:
    """Return as many zeros as what ``at_point`` says of ∇N has numbers."""
    raise NotImplementedError


@generic
def corner_values(cell: Any, values: Array, corner: Any) -> Corners:
    """Return the nodal ``values[n, 3]`` at the nodes ``corner`` of a cell."""
    raise NotImplementedError


@generic
def modes_of(cell: Any, values: Corners) -> Any:
    """Return the modes of a field by its corner values."""


@inline
def flattened(field: Any) -> tuple[float, ...]:
    """Return the numbers of a field's modes, or of what ``at_point`` says of ∇N."""
    return flat(field)


@generic
def unflattened(cell: Any, numbers: tuple[float, ...]) -> Any:
    """Return the field of some numbers."""


@generic
def moved(place: Any, step: float, velocity: Any) -> Any:
    """Return place + step velocity."""


@generic
def volume_gradient(place: Any) -> Any:
    """Return ∂V/∂(modes of x), what ∫∇N over the cell takes from each mode."""


@generic
def volume(place: Any, gradient: Any) -> float:
    """Return the exact volume of the cell."""
    raise NotImplementedError


@generic
def mean_gradient(field: Any, gradient: Any, scale: float) -> Columns:
    """Return ``scale`` ∫∂field/∂x over the cell: the field's mean gradient for scale = 1/V."""
    raise NotImplementedError


@generic
def hourglass_of(field: Any) -> Hourglass:
    """Return the part of a field that the mean gradient does not see."""
    raise NotImplementedError


@generic
def smallest_length(place: Any, gradient: Any, volume: float) -> float:
    """Return the least of the cell's thicknesses [mm]."""
    raise NotImplementedError


@generic
def stable_length(place: Any, gradient: Any, volume: float) -> float:
    """Return l such that no frequency of a cell of uniform strain exceeds 2c/l [mm]."""
    raise NotImplementedError


@inline
def no_force(cell: Any) -> Any:
    """Return no force on any mode."""
    return unflattened(cell, mode_numbers(cell))


@generic
def mean_forces(place: Any, gradient: Any, pull: Columns, h: Hourglass) -> Any:
    """Return the forces on the modes of a uniform stress ``pull``, and ``h`` on the hourglass modes."""


@generic
def add_pressure(on: Any, gradient: Any, pressure: float) -> Any:
    """Add the forces on the modes of a uniform pressure."""


@generic
def corner_forces(on: Any) -> Corners:
    """Return the corners' forces of those on the modes."""
    raise NotImplementedError


# --- one of the points of the full rule, which stand like the corners ---


@generic
def at_point(place: Any, flow: Any, dt: float, k: int) -> tuple[Columns, float, Any, float]:
    """Return what happens at point k of weight one.

    Returns:
        The displacement gradient of the step at mid-step and the point's volume there; what ∇N takes from each mode
        now, and the point's volume now.
    """
    raise NotImplementedError


@generic
def point_weights(cell: Any, numbers: tuple[float, ...]) -> Any:
    """Return what ``at_point`` said of ∇N by its numbers."""


@generic
def add_point_force(on: Any, weights: Any, stress: Columns, k: int) -> Any:
    """Add the forces on the modes that a stress at point k makes."""


@generic
def sharpest(place: Any, so_far: float, weights: Any, scale: float) -> float:
    """Return what the points up to this one take of shear, ``scale`` |weights|² each, for ``selective_length``."""
    raise NotImplementedError


@generic
def selective_length(place: Any, gradient: Any, volume: float, sharpest: float) -> float:
    """Return l such that no frequency of a selectively reduced cell exceeds 2c/l [mm]."""
    raise NotImplementedError


@inline
def dot_hourglass(a: Hourglass, b: Hourglass) -> float:
    """Return Σ a · b over the modes."""
    linear = fma_product(a.zeta_xi, b.zeta_xi, product(a.eta_zeta, b.eta_zeta))
    return total(fma_product(a.all, b.all, fma_product(a.xi_eta, b.xi_eta, linear)))
