"""The bilinear quadrilateral that turns around the z axis, described by its modes.

It lies in the half plane y = 0, x = r >= 0; what it sweeps is a ring. With reference coordinates ξ, η in [-1, 1], any
field that the four corner values span is

    x(ξ, η) = x_0 + a ξ + b η + g ξη,        det ∂x/∂(ξ, η) = a x b + (a x g) ξ + (g x b) η

Unlike in a hexahedron the mean is a mode too: a ring that widens is strained by v_r / r. Integrals are over the ring,
∫ 2π r dA, so that forces do the work of the stress on the strain of the whole ring: the volume-weighted (Galerkin)
form, not the area-weighted one of some hydrocodes. Corners are numbered as VTK does, counter-clockwise with x to the
right and z up.

``corner_forces`` takes a quarter of the forces on the modes to each corner.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import implements, inline
from viscopoint.kernels.packing import shaped
from viscopoint.kernels.tensors import Columns, applied
from viscopoint.kernels.vectors import Vec, dot
from viscopoint.methods.fem import cells
from viscopoint.methods.fem.cells import Corners, Hourglass

TWO_PI = 2.0 * math.pi
GAUSS = 1.0 / math.sqrt(3.0)  # of the 2 x 2 rule, whose points stand like the corners; it integrates all here exactly
#                0     1     2     3
XI = np.array([-1.0, 1.0, 1.0, -1.0])
ETA = np.array([-1.0, -1.0, 1.0, 1.0])
ON_AXIS = 1e-12  # of the ring's mean radius: corners no farther from the axis stand on it


class Ring(NamedTuple):
    """The cell; nothing to know of it."""


class Modes(NamedTuple):
    """A vector field over the element; y, around the axis, is 0."""

    mean: Vec  # x_0
    xi: Vec  # a
    eta: Vec  # b
    both: Vec  # g, of ξη


class Weights(Modes):
    """What ∫∂φ/∂r, ∫φ/r and ∫∂φ/∂z over a ring, or over the share of a point, take from each mode of φ: x, y, z."""


@implements(cells.weight_numbers, Ring)
@implements(cells.mode_numbers, Ring)
@implements(cells.corner_numbers, Ring)
def four_vectors(cell: Ring) -> tuple[float, ...]:
    return (0.0,) * 12


@implements(cells.corner_values, Ring)
def four_values(cell: Ring, values: Array, corner: Any) -> Corners:
    a, b, c, d = corner[0], corner[1], corner[2], corner[3]
    return (
        values[a, 0], values[a, 1], values[a, 2], values[b, 0], values[b, 1], values[b, 2],
        values[c, 0], values[c, 1], values[c, 2], values[d, 0], values[d, 1], values[d, 2],
    )  # fmt: skip


@implements(cells.modes_of, Ring)
def four_modes(cell: Ring, values: Corners) -> Modes:
    x = values
    a, b, c, d = Vec(x[0], x[1], x[2]), Vec(x[3], x[4], x[5]), Vec(x[6], x[7], x[8]), Vec(x[9], x[10], x[11])
    lower, upper, ab, dc = b - a, c - d, a + b, d + c
    return Modes(
        mean=0.25 * (ab + dc), xi=0.25 * (lower + upper), eta=0.25 * (dc - ab), both=0.25 * (upper - lower)
    )  # fmt: skip


@implements(cells.unflattened, Ring)
def of_flat(cell: Ring, numbers: tuple[float, ...]) -> Modes:
    return shaped(Modes, numbers)


@implements(cells.corner_forces, Modes)
def to_corners(on: Modes) -> Corners:
    a, b, c, d = at_corner(on, 0), at_corner(on, 1), at_corner(on, 2), at_corner(on, 3)
    return (
        0.25 * a.x, 0.0, 0.25 * a.z, 0.25 * b.x, 0.0, 0.25 * b.z,
        0.25 * c.x, 0.0, 0.25 * c.z, 0.25 * d.x, 0.0, 0.25 * d.z,
    )  # fmt: skip


@inline
def at_corner(on: Any, k: int) -> Vec:
    """Return the sum of what belongs to the modes, with the signs of a corner."""
    return on.mean + XI[k] * on.xi + ETA[k] * on.eta + (XI[k] * ETA[k]) * on.both


@implements(cells.moved, Modes)
def moved_on(place: Modes, step: float, velocity: Modes) -> Modes:
    return Modes(
        place.mean + step * velocity.mean,
        place.xi + step * velocity.xi,
        place.eta + step * velocity.eta,
        place.both + step * velocity.both,
    )


@implements(cells.volume_gradient, Modes)
def ring_weights(place: Modes) -> Weights:
    r, a, b, g = place.mean.x, place.xi, place.eta, place.both
    full, third = 4.0 * TWO_PI, 4.0 * TWO_PI / 3.0
    return Weights(
        Vec(0.0, full * _area(a, b), 0.0),
        Vec(
            full * r * b.z + third * a.x * g.z,
            third * _area(a, g),
            -full * r * b.x - third * a.x * g.x,
        ),
        Vec(
            -full * r * a.z - third * b.x * g.z,
            third * _area(g, b),
            full * r * a.x + third * b.x * g.x,
        ),
        Vec(third * (b.x * b.z - a.x * a.z), 0.0, third * (a.x * a.x - b.x * b.x)),
    )  # fmt: skip


@inline
def weights_at(place: Modes, xi: float, eta: float) -> tuple[Weights, float]:
    """Return the weights of a point of weight one, and the volume of the ring that it stands for [mm^3]."""
    r = place.mean.x + xi * place.xi.x + eta * place.eta.x + xi * eta * place.both.x
    a, b = place.xi + eta * place.both, place.eta + xi * place.both
    around, area = TWO_PI * r, _area(a, b)
    hoop = TWO_PI * area
    return Weights(
        Vec(0.0, hoop, 0.0),
        Vec(around * b.z, hoop * xi, -around * b.x),
        Vec(-around * a.z, hoop * eta, around * a.x),
        Vec(around * (eta * b.z - xi * a.z), hoop * xi * eta, around * (xi * a.x - eta * b.x)),
    ), around * area


@implements(cells.volume, Modes)
def exact_volume(place: Modes, gradient: Weights) -> float:
    a, b, g = place.xi, place.eta, place.both
    return 4.0 * TWO_PI * (place.mean.x * _area(a, b) + (a.x * _area(a, g) + b.x * _area(g, b)) / 3.0)


@implements(cells.mean_gradient, Modes)
def gradient_of_modes(field: Modes, gradient: Weights, scale: float) -> Columns:
    weights = gradient  # with v_r / r around the axis
    along_r = (
        weights.xi.x * field.xi + weights.eta.x * field.eta + weights.both.x * field.both
    )  # fmt: skip
    along_z = weights.xi.z * field.xi + weights.eta.z * field.eta + weights.both.z * field.both
    hoop = (
        weights.mean.y * field.mean.x + weights.xi.y * field.xi.x + weights.eta.y * field.eta.x
        + weights.both.y * field.both.x
    )  # fmt: skip
    return Columns(scale * along_r, Vec(0.0, scale * hoop, 0.0), scale * along_z)


@implements(cells.add_point_force, Modes)
def gathered(on: Modes, weights: Weights, stress: Columns, k: int) -> Modes:
    """Add what does the work of a stress on the ``mean_gradient`` of these weights; the hoop stress acts along r."""
    along = Columns(Vec(stress.x.x, 0.0, stress.x.z), Vec(stress.y.y, 0.0, 0.0), Vec(stress.z.x, 0.0, stress.z.z))
    return Modes(
        on.mean + applied(along, weights.mean),
        on.xi + applied(along, weights.xi),
        on.eta + applied(along, weights.eta),
        on.both + applied(along, weights.both),
    )


@implements(cells.smallest_length, Modes)
def thinnest(place: Modes, gradient: Weights, volume: float) -> float:
    # of the two thicknesses in the half plane; below zero where the element is inside out
    a, b = place.xi, place.eta
    return 2.0 * _area(a, b) / math.sqrt(max(dot(a, a), dot(b, b)))


# --- the stable step ---


@inline
def corner_volumes(place: Modes) -> Modes:
    """Return what the ring's volume puts on the modes, ∫(1, ξ, η, ξη), for ``at_corner``; in x alone [mm^3]."""
    r, a, b, g = place.mean.x, place.xi, place.eta, place.both
    k, k_xi, k_eta = _area(a, b), _area(a, g), _area(g, b)
    full = TWO_PI  # a quarter of 4 TWO_PI
    return Modes(
        Vec(full * (r * k + (a.x * k_xi + b.x * k_eta) / 3.0), 0.0, 0.0),
        Vec(full * ((r * k_xi + a.x * k) / 3.0 + g.x * k_eta / 9.0), 0.0, 0.0),
        Vec(full * ((r * k_eta + b.x * k) / 3.0 + g.x * k_xi / 9.0), 0.0, 0.0),
        Vec(full * (a.x * k_eta + b.x * k_xi + g.x * k) / 9.0, 0.0, 0.0),
    )


@inline
def on_axis(place: Modes, k: int) -> bool:
    """Return whether a corner stands on the axis."""
    return at_corner(place, k).x <= ON_AXIS * place.mean.x


@inline
def volumetric(place: Modes, weights: Weights) -> float:
    """Return Σ |w_i|² / V_i over the corners, w_i what a corner's motion changes the volume by."""
    found, shares = 0.0, corner_volumes(place)
    for k in range(4):
        w = 0.25 * at_corner(weights, k)
        widening = 0.0 if on_axis(place, k) else w.x + w.y
        found += (widening * widening + w.z * w.z) / at_corner(shares, k).x
    return found


@inline
def shearing(place: Modes, weights: Weights) -> float:
    """Return Σ λ_i / V_i over the corners, λ_i the largest square of the deviator that a corner's motion makes.

    That square is a quadratic form of (v_r, v_z) with the entries below, and where the axis holds the corner of v_z
    alone.
    """
    found, shares = 0.0, corner_volumes(place)
    for k in range(4):
        w = 0.25 * at_corner(weights, k)
        out = 2.0 / 3.0 * (w.x * w.x + w.y * w.y - w.x * w.y) + 0.5 * w.z * w.z
        up = 2.0 / 3.0 * w.z * w.z + 0.5 * w.x * w.x
        mixed = w.z * (w.x - 2.0 * w.y) / 6.0
        largest = 0.5 * (out + up) + math.sqrt(0.25 * (out - up) ** 2 + mixed * mixed)
        found += (up if on_axis(place, k) else largest) / at_corner(shares, k).x
    return found


@implements(cells.stable_length, Modes)
def ring_length(place: Modes, gradient: Weights, volume: float) -> float:
    return longest(volumetric(place, gradient) / volume, shearing(place, gradient) / volume)


@implements(cells.sharpest, Modes)
def more_shear(place: Modes, so_far: float, weights: Weights, scale: float) -> float:
    return so_far + scale * shearing(place, weights)


@implements(cells.selective_length, Modes)
def with_shear(place: Modes, gradient: Weights, volume: float, sharpest: float) -> float:
    return longest(volumetric(place, gradient) / volume, sharpest)


@inline
def longest(volumetric_strain: float, shear: float) -> float:
    """Return l such that no element frequency exceeds 2c/l, from what either takes per volume of the ring [1/mm^2].

    By Cauchy and Schwarz ω² <= (K ``volumetric_strain`` + 2G ``shear``) / ρ, and with M = K + 4G/3 no more than the
    larger of c² ``volumetric_strain`` and 3/2 c² ``shear``. Corners weigh what their share of the ring does: beside the
    axis, that is little.
    """
    return 2.0 / math.sqrt(max(volumetric_strain, 1.5 * shear))


# --- forces ---


@implements(cells.hourglass_of, Modes)
def the_only_one(field: Modes) -> Hourglass:
    none = Vec(0.0, 0.0, 0.0)
    return Hourglass(none, none, none, field.both)


@implements(cells.mean_forces, Modes)
def of_mean_stress(place: Modes, gradient: Weights, pull: Columns, h: Hourglass) -> Modes:
    none = Vec(0.0, 0.0, 0.0)
    return cells.add_point_force(Modes(none, none, none, h.all), gradient, pull, 0)


@implements(cells.add_pressure, Modes)
def with_pressure(on: Modes, gradient: Weights, pressure: float) -> Modes:
    pull = Columns(Vec(pressure, 0.0, 0.0), Vec(0.0, pressure, 0.0), Vec(0.0, 0.0, pressure))
    return cells.add_point_force(on, gradient, pull, 0)


@implements(cells.at_point, Modes)
def at_gauss_point(place: Modes, flow: Modes, dt: float, k: int) -> tuple[Columns, float, Weights, float]:
    xi, eta = GAUSS * XI[k], GAUSS * ETA[k]
    half, mid_volume = weights_at(cells.moved(place, -0.5 * dt, flow), xi, eta)
    weights, share = weights_at(place, xi, eta)
    return cells.mean_gradient(flow, half, dt / mid_volume), mid_volume, weights, share


@implements(cells.point_weights, Ring)
def weights_of(cell: Ring, numbers: tuple[float, ...]) -> Weights:
    return shaped(Weights, numbers)


@inline
def _area(a: Vec, b: Vec) -> float:
    """Return a x b in the half plane, above zero where b is to the left of a."""
    return a.x * b.z - a.z * b.x
