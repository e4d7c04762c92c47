"""The bilinear quadrilateral that turns around the z axis, described by its modes.

It lies in the half plane y = 0, x = r >= 0; what it sweeps is a ring. With reference coordinates ξ, η in [-1, 1], any
field that the four corner values span is

    x(ξ, η) = x_0 + a ξ + b η + g ξη,        det ∂x/∂(ξ, η) = a x b + (a x g) ξ + (g x b) η

Unlike in a hexahedron the mean is a mode too: a ring that widens is strained by v_r / r. Integrals are over the ring,
∫ 2π r dA, so that forces do the work of the stress on the strain of the whole ring: the volume-weighted (Galerkin)
form, not the area-weighted one of some hydrocodes. Corners are numbered as VTK does, counter-clockwise with x to the
right and z up.

The force that works on a mode is the sum of the corner forces with the mode's signs; ``spread`` takes a quarter of it
to each corner.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import inline
from viscopoint.kernels.tensors import Columns, Sym, Vec, applied, dot

TURN = 2.0 * math.pi
GAUSS = 1.0 / math.sqrt(3.0)  # of the 2 x 2 rule, whose points stand like the corners; it integrates all here exactly
#                0     1     2     3
XI = np.array([-1.0, 1.0, 1.0, -1.0])
ETA = np.array([-1.0, -1.0, 1.0, 1.0])


class Modes(NamedTuple):
    """A vector field over the element; y, around the axis, is 0."""

    mean: Vec  # x_0
    xi: Vec  # a
    eta: Vec  # b
    both: Vec  # g, of ξη


class Weights(NamedTuple):
    """What ∫∂φ/∂r, ∫φ/r and ∫∂φ/∂z over a ring, or over the share of a point, take from each mode of φ: x, y, z."""

    mean: Vec
    xi: Vec
    eta: Vec
    both: Vec


@inline
def modes(values: Array, corner: Any) -> Modes:
    """Return the modes of the nodal ``values[n, 3]`` at the nodes ``corner[4]`` of an element."""
    a, b, c, d = _row(values, corner[0]), _row(values, corner[1]), _row(values, corner[2]), _row(values, corner[3])
    lower, upper, ab, dc = b - a, c - d, a + b, d + c
    return Modes(
        mean=0.25 * (ab + dc), xi=0.25 * (lower + upper), eta=0.25 * (dc - ab), both=0.25 * (upper - lower)
    )  # fmt: skip


@inline
def no_force() -> Modes:
    """Return no force on any mode."""
    none = Vec(0.0, 0.0, 0.0)
    return Modes(none, none, none, none)


@inline
def spread(force: Array, corner: Any, on: Modes) -> None:
    """Add the forces on the modes to the nodal ``force[n, 3]``, a quarter of them to each corner."""
    for k in range(4):
        f = at_corner(on, k)
        force[corner[k], 0] += 0.25 * f.x
        force[corner[k], 2] += 0.25 * f.z


@inline
def at_corner(on: Any, k: int) -> Vec:
    """Return the sum of what belongs to the modes, with the signs of a corner."""
    return on.mean + XI[k] * on.xi + ETA[k] * on.eta + (XI[k] * ETA[k]) * on.both


@inline
def moved(place: Modes, step: float, velocity: Modes) -> Modes:
    """Return place + step velocity."""
    return Modes(
        place.mean + step * velocity.mean,
        place.xi + step * velocity.xi,
        place.eta + step * velocity.eta,
        place.both + step * velocity.both,
    )


@inline
def ring_weights(place: Modes) -> Weights:
    """Return the weights of the whole ring, integrated exactly."""
    r, a, b, g = place.mean.x, place.xi, place.eta, place.both
    full, third = 4.0 * TURN, 4.0 * TURN / 3.0
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
def point_weights(place: Modes, xi: float, eta: float) -> tuple[Weights, float]:
    """Return the weights of a point of weight one, and the volume of the ring that it stands for [mm^3]."""
    r = place.mean.x + xi * place.xi.x + eta * place.eta.x + xi * eta * place.both.x
    a, b = place.xi + eta * place.both, place.eta + xi * place.both
    around, area = TURN * r, _area(a, b)
    hoop = TURN * area
    return Weights(
        Vec(0.0, hoop, 0.0),
        Vec(around * b.z, hoop * xi, -around * b.x),
        Vec(-around * a.z, hoop * eta, around * a.x),
        Vec(around * (eta * b.z - xi * a.z), hoop * xi * eta, around * (xi * a.x - eta * b.x)),
    ), around * area


@inline
def volume(place: Modes) -> float:
    """Return the exact volume of the ring."""
    a, b, g = place.xi, place.eta, place.both
    return 4.0 * TURN * (place.mean.x * _area(a, b) + (a.x * _area(a, g) + b.x * _area(g, b)) / 3.0)


@inline
def gradient(field: Modes, weights: Weights, scale: float) -> Columns:
    """Return scale times the integral of the field's gradient, with v_r / r around the axis."""
    along_r = (
        weights.xi.x * field.xi + weights.eta.x * field.eta + weights.both.x * field.both
    )  # fmt: skip
    along_z = weights.xi.z * field.xi + weights.eta.z * field.eta + weights.both.z * field.both
    hoop = (
        weights.mean.y * field.mean.x + weights.xi.y * field.xi.x + weights.eta.y * field.eta.x
        + weights.both.y * field.both.x
    )  # fmt: skip
    return Columns(scale * along_r, Vec(0.0, scale * hoop, 0.0), scale * along_z)


@inline
def pulling(stress: Sym) -> Columns:
    """Return what a stress makes of the weights of a mode: the force on it; that of the hoop stress is along r."""
    return Columns(Vec(stress.xx, 0.0, stress.zx), Vec(stress.yy, 0.0, 0.0), Vec(stress.zx, 0.0, stress.zz))


@inline
def gathered(on: Modes, pull: Columns, weights: Weights) -> Modes:
    """Add to the forces on the modes what does the work of a stress on the ``gradient`` of these weights."""
    return Modes(
        on.mean + applied(pull, weights.mean),
        on.xi + applied(pull, weights.xi),
        on.eta + applied(pull, weights.eta),
        on.both + applied(pull, weights.both),
    )


@inline
def smallest_length(place: Modes) -> float:
    """Return the lesser of the element's two thicknesses in the half plane."""
    a, b = place.xi, place.eta
    return 2.0 * _area(a, b) / math.sqrt(max(dot(a, a), dot(b, b)))


# --- the stable step ---


@inline
def corner_volumes(place: Modes) -> Modes:
    """Return what the ring's volume puts on the modes, ∫(1, ξ, η, ξη), for ``at_corner``; in x alone [mm^3]."""
    r, a, b, g = place.mean.x, place.xi, place.eta, place.both
    k, k_xi, k_eta = _area(a, b), _area(a, g), _area(g, b)
    full = TURN  # a quarter of 4 TURN
    return Modes(
        Vec(full * (r * k + (a.x * k_xi + b.x * k_eta) / 3.0), 0.0, 0.0),
        Vec(full * ((r * k_xi + a.x * k) / 3.0 + g.x * k_eta / 9.0), 0.0, 0.0),
        Vec(full * ((r * k_eta + b.x * k) / 3.0 + g.x * k_xi / 9.0), 0.0, 0.0),
        Vec(full * (a.x * k_eta + b.x * k_xi + g.x * k) / 9.0, 0.0, 0.0),
    )


@inline
def swelling(weights: Weights, shares: Modes, corner: Any, fixed: Any) -> float:
    """Return Σ |w_i|² / V_i over the corners, w_i what a corner's motion changes the volume by."""
    found = 0.0
    for k in range(4):
        w = 0.25 * at_corner(weights, k)
        widening = 0.0 if fixed[corner[k]] & 1 else w.x + w.y
        found += (widening * widening + w.z * w.z) / at_corner(shares, k).x
    return found


@inline
def shearing(weights: Weights, shares: Modes, corner: Any, fixed: Any) -> float:
    """Return Σ λ_i / V_i over the corners, λ_i the largest square of the deviator that a corner's motion makes.

    That square is a quadratic form of (v_r, v_z) with the entries below, and where the axis holds the corner of v_z
    alone.
    """
    found = 0.0
    for k in range(4):
        w = 0.25 * at_corner(weights, k)
        out = 2.0 / 3.0 * (w.x * w.x + w.y * w.y - w.x * w.y) + 0.5 * w.z * w.z
        up = 2.0 / 3.0 * w.z * w.z + 0.5 * w.x * w.x
        mixed = w.z * (w.x - 2.0 * w.y) / 6.0
        largest = 0.5 * (out + up) + math.sqrt(0.25 * (out - up) ** 2 + mixed * mixed)
        found += (up if fixed[corner[k]] & 1 else largest) / at_corner(shares, k).x
    return found


@inline
def stable_length(swelling: float, shearing: float) -> float:
    """Return l such that no element frequency exceeds 2c/l, from what either takes per volume of the ring [1/mm^2].

    By Cauchy and Schwarz ω² <= (K swelling + 2G shearing) / ρ, and with M = K + 4G/3 no more than the larger of
    c² swelling and 3/2 c² shearing. Corners weigh what their share of the ring does: beside the axis, that is little.
    """
    return 2.0 / math.sqrt(max(swelling, 1.5 * shearing))


@inline
def _area(a: Vec, b: Vec) -> float:
    """Return a x b in the half plane, above zero where b is to the left of a."""
    return a.x * b.z - a.z * b.x


@inline
def _row(values: Array, n: Any) -> Vec:
    return Vec(values[n, 0], values[n, 1], values[n, 2])
