"""The trilinear hexahedron, described by its modes.

With reference coordinates ξ, η, ζ in [-1, 1], any field that the eight corner values span is

    x(ξ, η, ζ) = x_0 + a ξ + b η + c ζ + d ηζ + e ζξ + f ξη + g ξηζ

The constant says nothing of strain. Three modes are linear; the other four, which a uniform strain does not see, are
the hourglass modes. Corners are numbered as VTK does: the lower face around, then the upper one.

``corner_forces`` takes an eighth of the forces on the modes to each corner.
"""

from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import implements, inline
from viscopoint.kernels.packing import shaped
from viscopoint.kernels.values import fma
from viscopoint.kernels.vectors import Vec
from viscopoint.methods.fem import cells
from viscopoint.methods.fem.cells import Corners

#                  0     1     2     3     4     5     6     7
XI = np.array([-1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0])
ETA = np.array([-1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0])
ZETA = np.array([-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0])


class Hexahedron(NamedTuple):
    """The cell; nothing to know of it."""


class Modes(NamedTuple):
    """A vector field over the element, less its mean."""

    xi: Vec  # a
    eta: Vec  # b
    zeta: Vec  # c
    eta_zeta: Vec  # d
    zeta_xi: Vec  # e
    xi_eta: Vec  # f
    all: Vec  # g, of ξηζ


@inline
def modes(values: Array, corner: Any) -> Modes:
    """Return the modes of the nodal ``values[n, 3]`` at the nodes ``corner[8]`` of an element."""
    return cells.modes_of(Hexahedron(), cells.corner_values(Hexahedron(), values, corner))


@implements(cells.corner_numbers, Hexahedron)
def of_corners(cell: Hexahedron) -> Corners:
    return (0.0,) * 24


@implements(cells.mode_numbers, Hexahedron)
def of_modes(cell: Hexahedron) -> tuple[float, ...]:
    return (0.0,) * 21


@implements(cells.corner_values, Hexahedron)
def eight_values(cell: Hexahedron, values: Array, corner: Any) -> Corners:
    a, b, c, d, e, f, g, h = (
        corner[0], corner[1], corner[2], corner[3], corner[4], corner[5], corner[6], corner[7]
    )  # fmt: skip
    return (
        values[a, 0], values[a, 1], values[a, 2], values[b, 0], values[b, 1], values[b, 2],
        values[c, 0], values[c, 1], values[c, 2], values[d, 0], values[d, 1], values[d, 2],
        values[e, 0], values[e, 1], values[e, 2], values[f, 0], values[f, 1], values[f, 2],
        values[g, 0], values[g, 1], values[g, 2], values[h, 0], values[h, 1], values[h, 2],
    )  # fmt: skip


@implements(cells.modes_of, Hexahedron)
def seven_modes(cell: Hexahedron, values: Corners) -> Modes:
    x = values
    a, b, c, d = Vec(x[0], x[1], x[2]), Vec(x[3], x[4], x[5]), Vec(x[6], x[7], x[8]), Vec(x[9], x[10], x[11])
    e, f, g, h = Vec(x[12], x[13], x[14]), Vec(x[15], x[16], x[17]), Vec(x[18], x[19], x[20]), Vec(x[21], x[22], x[23])
    ba, cd, fe, gh = b - a, c - d, f - e, g - h
    ab, dc, ef, hg = a + b, c + d, e + f, g + h
    lower, upper, lower_eta, upper_eta = ba + cd, fe + gh, cd - ba, gh - fe
    front, back, bottom, top = dc - ab, hg - ef, ab + dc, ef + hg
    return Modes(
        xi=0.125 * (lower + upper),
        eta=0.125 * (front + back),
        zeta=0.125 * (top - bottom),
        eta_zeta=0.125 * (back - front),
        zeta_xi=0.125 * (upper - lower),
        xi_eta=0.125 * (lower_eta + upper_eta),
        all=0.125 * (upper_eta - lower_eta),
    )


@implements(cells.unflattened, Hexahedron)
def of_flat(cell: Hexahedron, numbers: tuple[float, ...]) -> Modes:
    return shaped(Modes, numbers)


@implements(cells.corner_forces, Modes)
def to_corners(on: Modes) -> Corners:
    p, q, r = on.xi - on.zeta_xi, on.eta - on.eta_zeta, on.xi_eta - on.all
    t, u, v = on.xi + on.zeta_xi, on.eta + on.eta_zeta, on.xi_eta + on.all
    along, across = p + q, p - q
    a, b = 0.125 * (r - on.zeta - along), 0.125 * (across - r - on.zeta)
    c, d = 0.125 * (along + r - on.zeta), (-0.125) * (across + r + on.zeta)
    along, across = t + u, t - u
    e, f = 0.125 * (on.zeta + v - along), 0.125 * (on.zeta + across - v)
    g, h = 0.125 * (on.zeta + along + v), 0.125 * (on.zeta - across - v)
    return (
        a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z,
        e.x, e.y, e.z, f.x, f.y, f.z, g.x, g.y, g.z, h.x, h.y, h.z,
    )  # fmt: skip


@implements(cells.moved, Modes)
def moved_on(place: Modes, step: float, velocity: Modes) -> Modes:
    return Modes(
        fma(step, velocity.xi, place.xi),
        fma(step, velocity.eta, place.eta),
        fma(step, velocity.zeta, place.zeta),
        fma(step, velocity.eta_zeta, place.eta_zeta),
        fma(step, velocity.zeta_xi, place.zeta_xi),
        fma(step, velocity.xi_eta, place.xi_eta),
        fma(step, velocity.all, place.all),
    )
