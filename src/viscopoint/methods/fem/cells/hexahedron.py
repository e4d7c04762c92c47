"""What elements ask of a hexahedron: volume and its gradient, mean strain, forces, lengths, and the 2 x 2 x 2 rule."""

import math
from typing import NamedTuple

from viscopoint.kernels.jit import implements, inline
from viscopoint.kernels.packing import shaped
from viscopoint.kernels.tensors import Columns, applied
from viscopoint.kernels.values import fma
from viscopoint.kernels.vectors import Vec, cross, dot, fma_product, product, total
from viscopoint.methods.fem import cells
from viscopoint.methods.fem.cells import Hourglass
from viscopoint.methods.fem.cells.hexahedron_modes import ETA, XI, ZETA, Hexahedron, Modes

GAUSS = 1.0 / math.sqrt(3.0)  # of the 2 x 2 x 2 rule, whose points stand like the corners


class Gradient(NamedTuple):
    """∂V/∂(modes of x) = ∫∇N over the element, by modes; that of ξηζ is nil."""

    xi: Vec
    eta: Vec
    zeta: Vec
    eta_zeta: Vec
    zeta_xi: Vec
    xi_eta: Vec


class Slopes(NamedTuple):
    """Three vectors that belong to the directions of ξ, η and ζ."""

    xi: Vec
    eta: Vec
    zeta: Vec


@implements(cells.volume_gradient, Modes)
def gradient_of_volume(place: Modes) -> Gradient:
    # of V = 8 [a·(b x c) - (a·(e x f) + b·(f x d) + c·(d x e)) / 3]
    a, b, c, d, e, f, _ = place
    third = 8.0 / 3.0
    return Gradient(
        8.0 * cross(b, c) - third * cross(e, f),
        8.0 * cross(c, a) - third * cross(f, d),
        8.0 * cross(a, b) - third * cross(d, e),
        (-third) * (cross(b, f) + cross(e, c)),
        (-third) * (cross(f, a) + cross(c, d)),
        (-third) * (cross(a, e) + cross(d, b)),
    )


@implements(cells.volume, Modes)
def exact_volume(place: Modes, gradient: Gradient) -> float:
    # a cubic in the modes: by Euler, a third of x·∂V/∂x
    a, b, c, d, e, f, _ = place
    w = gradient
    linear = fma_product(c, w.zeta, fma_product(b, w.eta, product(a, w.xi)))
    return total(fma_product(f, w.xi_eta, fma_product(e, w.zeta_xi, fma_product(d, w.eta_zeta, linear)))) / 3.0


@implements(cells.mean_gradient, Modes)
def gradient_of_modes(field: Modes, gradient: Gradient, scale: float) -> Columns:
    a, b, c, d, e, f, _ = field
    w = gradient
    return Columns(
        scale * _six(w.xi.x, a, w.eta.x, b, w.zeta.x, c, w.eta_zeta.x, d, w.zeta_xi.x, e, w.xi_eta.x, f),
        scale * _six(w.xi.y, a, w.eta.y, b, w.zeta.y, c, w.eta_zeta.y, d, w.zeta_xi.y, e, w.xi_eta.y, f),
        scale * _six(w.xi.z, a, w.eta.z, b, w.zeta.z, c, w.eta_zeta.z, d, w.zeta_xi.z, e, w.xi_eta.z, f),
    )


@inline
def _six(
    a: float, x: Vec, b: float, y: Vec, c: float, z: Vec, d: float, u: Vec, e: float, v: Vec, f: float, w: Vec
) -> Vec:
    """Return the sum of six products."""
    return fma(f, w, fma(e, v, fma(d, u, fma(c, z, fma(b, y, a * x)))))


@inline
def slopes(field: Modes, xi: float, eta: float, zeta: float) -> Slopes:
    """Return the derivatives of a field along ξ, η and ζ at a place in the element."""
    return Slopes(
        fma(eta * zeta, field.all, fma(eta, field.xi_eta, fma(zeta, field.zeta_xi, field.xi))),
        fma(zeta * xi, field.all, fma(xi, field.xi_eta, fma(zeta, field.eta_zeta, field.eta))),
        fma(xi * eta, field.all, fma(xi, field.zeta_xi, fma(eta, field.eta_zeta, field.zeta))),
    )


@inline
def areas(tangents: Slopes) -> tuple[Slopes, float]:
    """Return the cross products of the tangents ∂x/∂ξ, each normal to two of them, and their determinant."""
    a, b, c = tangents.xi, tangents.eta, tangents.zeta
    normal = cross(b, c)
    return Slopes(normal, cross(c, a), cross(a, b)), dot(a, normal)


@inline
def local_gradient(field: Slopes, faces: Slopes, scale: float) -> Columns:
    """Return scale det ∂field/∂x at the place where field and ``areas`` were taken."""
    a, b, c = field
    return Columns(
        scale * fma(faces.zeta.x, c, fma(faces.eta.x, b, faces.xi.x * a)),
        scale * fma(faces.zeta.y, c, fma(faces.eta.y, b, faces.xi.y * a)),
        scale * fma(faces.zeta.z, c, fma(faces.eta.z, b, faces.xi.z * a)),
    )


@implements(cells.smallest_length, Modes)
def thinnest(place: Modes, gradient: Gradient, volume: float) -> float:
    # V over the area of a section between opposite faces
    xi, eta, zeta = gradient.xi, gradient.eta, gradient.zeta
    largest = max(dot(xi, xi), max(dot(eta, eta), dot(zeta, zeta)))
    return 2.0 * volume / math.sqrt(largest)


@implements(cells.stable_length, Modes)
def brick_length(place: Modes, gradient: Gradient, volume: float) -> float:
    """Return l, 1/l² = Σ 1/l_k² of a brick's three edges.

    The power of a stress is Σ v_m · σ ∂V/∂x_m and the element's mass, an eighth at each corner, moves with v_m², so
    that by Cauchy and Schwarz ω² <= M Σ |∂V/∂x_m|² / (ρ V²) (after Flanagan & Belytschko 1984). The smallest edge
    alone, l/c, is too long a step where an element swells along all three axes at once, as it easily does in a soft
    solid of high bulk modulus.
    """
    w = gradient
    linear = fma_product(w.zeta, w.zeta, fma_product(w.eta, w.eta, product(w.xi, w.xi)))
    d, e, f = w.eta_zeta, w.zeta_xi, w.xi_eta
    return 2.0 * volume / math.sqrt(total(fma_product(f, f, fma_product(e, e, fma_product(d, d, linear)))))


@implements(cells.hourglass_of, Modes)
def four_of_seven(field: Modes) -> Hourglass:
    return Hourglass(field.eta_zeta, field.zeta_xi, field.xi_eta, field.all)


@implements(cells.mean_forces, Modes)
def of_mean_stress(place: Modes, gradient: Gradient, pull: Columns, h: Hourglass) -> Modes:
    return Modes(
        applied(pull, gradient.xi),
        applied(pull, gradient.eta),
        applied(pull, gradient.zeta),
        h.eta_zeta + applied(pull, gradient.eta_zeta),
        h.zeta_xi + applied(pull, gradient.zeta_xi),
        h.xi_eta + applied(pull, gradient.xi_eta),
        h.all,
    )


@implements(cells.add_pressure, Modes)
def with_pressure(on: Modes, gradient: Gradient, pressure: float) -> Modes:
    return Modes(
        on.xi + pressure * gradient.xi,
        on.eta + pressure * gradient.eta,
        on.zeta + pressure * gradient.zeta,
        on.eta_zeta + pressure * gradient.eta_zeta,
        on.zeta_xi + pressure * gradient.zeta_xi,
        on.xi_eta + pressure * gradient.xi_eta,
        on.all,
    )


@implements(cells.at_point, Modes)
def at_gauss_point(place: Modes, flow: Modes, dt: float, k: int) -> tuple[Columns, float, Slopes, float]:
    xi, eta, zeta = GAUSS * XI[k], GAUSS * ETA[k], GAUSS * ZETA[k]
    here, motion = slopes(place, xi, eta, zeta), slopes(flow, xi, eta, zeta)
    middle, det_middle = areas(Slopes(
        here.xi - 0.5 * dt * motion.xi, here.eta - 0.5 * dt * motion.eta, here.zeta - 0.5 * dt * motion.zeta
    ))  # fmt: skip
    faces, det = areas(here)
    return local_gradient(motion, middle, dt / det_middle), det_middle, faces, det


@implements(cells.weight_numbers, Hexahedron)
def of_point(cell: Hexahedron) -> tuple[float, ...]:
    return (0.0,) * 9


@implements(cells.point_weights, Hexahedron)
def faces_of(cell: Hexahedron, numbers: tuple[float, ...]) -> Slopes:
    return shaped(Slopes, numbers)


@implements(cells.add_point_force, Modes)
def gathered(on: Modes, weights: Slopes, stress: Columns, k: int) -> Modes:
    """Add the transpose of ``slopes``."""
    xi, eta, zeta = GAUSS * XI[k], GAUSS * ETA[k], GAUSS * ZETA[k]
    a, b, c = applied(stress, weights.xi), applied(stress, weights.eta), applied(stress, weights.zeta)
    return Modes(
        on.xi + a,
        on.eta + b,
        on.zeta + c,
        fma(eta, c, fma(zeta, b, on.eta_zeta)),
        fma(xi, c, fma(zeta, a, on.zeta_xi)),
        fma(xi, b, fma(eta, a, on.xi_eta)),
        fma(xi * eta, c, fma(zeta * xi, b, fma(eta * zeta, a, on.all))),
    )


@implements(cells.sharpest, Modes)
def greatest_area(place: Modes, so_far: float, weights: Slopes, scale: float) -> float:
    area = dot(weights.xi, weights.xi) + dot(weights.eta, weights.eta) + dot(weights.zeta, weights.zeta)
    return max(so_far, scale * area)


@implements(cells.selective_length, Modes)
def with_shear(place: Modes, gradient: Gradient, volume: float, sharpest: float) -> float:
    # shear at eight points: 2G Σ V |dev ε|² <= 4G/3 · 8 max(V area/det²) of the modes' squares (see ``brick_length``)
    return min(cells.stable_length(place, gradient, volume), 2.0 * math.sqrt(volume / (8.0 * sharpest)))
