"""Bodies of hexahedra with flat sides, and finite element methods on them.

Bulk viscosity is off: it would smear the fronts and damp the waves that are compared with exact solutions without it.
For a wave along a row of cubes, masses stand at the nodes and an element knows the difference of two of them. So steps
of Courant number C give

    sin(w dt / 2) = C sin(kh / 2)    =>    w = c k (1 - DISPERSION (kh)^2 + ...).
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from columns import COURANT, LENGTH, viscoelastic
from material_point import State
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.optimize import least_squares

from viscopoint.interactions.planes import Interaction, rigid_wall, symmetry_plane
from viscopoint.kernels.arrays import Real
from viscopoint.kernels.tensors import COMPONENTS
from viscopoint.methods.fem.elements import Element
from viscopoint.methods.fem.elements.one_point import OnePoint
from viscopoint.methods.fem.elements.selective import Selective
from viscopoint.methods.fem.forms import quality
from viscopoint.methods.fem.hourglass import StiffnessControl, ViscousControl
from viscopoint.methods.fem.mesh import node_volumes, stable_lengths
from viscopoint.methods.fem.method import Discretisation, FiniteElementMethod
from viscopoint.model.body import Body, Surface
from viscopoint.model.viscosity import BulkViscosity

Array = NDArray[np.float64]
Boundaries = tuple[Interaction, ...]
VISCOUS, STIFF, SELECTIVE = OnePoint(ViscousControl()), OnePoint(StiffnessControl()), Selective()
ELEMENTS = {"viscous": VISCOUS, "stiffness": STIFF, "selective": SELECTIVE}
each_element = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS.keys())
ELASTIC = viscoelastic(0.0)  # an arm that never relaxes: the same kernels serve all tests
DISPERSION = (1 - COURANT**2) / 24
ON_WALL = (rigid_wall(0.0, 0.0),)


def brick(size: tuple[float, ...], cells: tuple[int, ...], shake: float = 0.0, foot: float = 0.0) -> Body:
    """Return a block around the z axis above z = ``foot``; inner nodes are moved at random by up to ``shake`` [mm]."""
    counts = [n + 1 for n in cells]
    planes = [np.linspace(0.0, 1.0, n) for n in counts]
    z, y, x = (axis.ravel() for axis in np.meshgrid(*planes[::-1], indexing="ij"))
    position: Array = (np.column_stack([x, y, z]) - [0.5, 0.5, 0.0]) * size + [0.0, 0.0, foot]
    inner = ~outside(position)
    position[inner] += np.random.default_rng(7).uniform(-shake, shake, (int(inner.sum()), 3))
    node = np.arange(len(position)).reshape(counts[::-1])
    low, high = slice(None, -1), slice(1, None)
    square = ((low, low), (low, high), (high, high), (high, low))  # y and x of the corners, around
    corners = [node[(level, *places)].ravel() for level in (low, high) for places in square]
    cell = np.column_stack(corners)
    layers = node.reshape(counts[2], -1)
    ends = [np.column_stack([layers[a], layers[b]]) for a, b in ((-1, -2), (0, 1))]
    surface = Surface(layers, np.ones(layers.shape[1]), 1.0, ends[0], ends[1], 0.0, 0.0)
    return Body(position, node_volumes(position, cell), surface, cell)


def outside(position: Array) -> NDArray[np.bool_]:
    """Return which nodes stand on the sides of the block that the nodes fill."""
    low, high = position.min(axis=0), position.max(axis=0)
    return ((position == low) | (position == high)).any(axis=1)


def fem(
    body: Body,
    element: Element,
    law: Any = ELASTIC,
    boundaries: Boundaries = (),
    velocity: Any = (0.0, 0.0, 0.0),
    courant: float = COURANT,
    viscosity: tuple[float, float] = (0.0, 0.0),
    delete_below: float = 0.0,
    real: Real = np.float64,
    safety: float = 0.0,
) -> FiniteElementMethod:
    """Return a method whose step is ``courant`` times that of a wave along the shortest edge, if not ``safety``."""
    if not safety:
        lengths = stable_lengths(body.position, body.cells)
        safety = courant * float(quality(body.position, body.cells).smallest_edge / lengths.min())
    choices = Discretisation(element, safety, BulkViscosity(*viscosity), delete_below, real)
    return FiniteElementMethod(body, law, boundaries, choices, velocity)


def bar(
    cells: int,
    element: Element,
    law: Any = ELASTIC,
    boundaries: Boundaries = ON_WALL,
    velocity: Callable[[Array], Array] = np.zeros_like,
    courant: float = COURANT,
    thick: float = 1.0,
) -> FiniteElementMethod:
    """Return a row of bricks along z, ``thick`` times as wide as high, its foot on z = 0, at ``velocity(position)``."""
    side = thick * LENGTH / cells
    body = brick((side, side, LENGTH), (1, 1, cells))
    return fem(body, element, law, boundaries, velocity(body.position), courant)


def column(
    cells: int, element: Element, law: Any = ELASTIC, boundaries: Boundaries = ON_WALL, **motion: Any
) -> FiniteElementMethod:
    """Return such a row of cubes between rollers on its four sides: one-dimensional."""
    half = 0.5 * LENGTH / cells
    rollers = [symmetry_plane(axis, place) for axis in (0, 1) for place in (-half, half)]
    return bar(cells, element, law, (*boundaries, *rollers), **motion)


def upward(speed: Callable[[Array], Array]) -> Callable[[Array], Array]:
    """Return the velocity field of a speed along z that depends on z."""
    return lambda position: np.outer(speed(position[:, 2]), [0.0, 0.0, 1.0])


def layers(method: FiniteElementMethod, values: Array) -> Array:
    """Average values of nodes over each layer, from the foot up."""
    return values[method.body.surface.ring].mean(axis=1)


def area(method: FiniteElementMethod) -> float:
    """Return the cross-section of a block [mm^2]."""
    return float(np.prod(np.ptp(method.body.position, axis=0)[:2]))


def answer(method: FiniteElementMethod, velocity: Array, dt: float) -> Array:
    """Move the nodes for a step at a velocity, whatever the forces; return the forces that the elements then have."""
    nodes = method.nodes
    nodes.velocity[:] = velocity
    nodes.position[:] += dt * velocity
    nodes.force[:] = 0.0
    method.strain(dt)
    return nodes.force.copy()


def highest(method: FiniteElementMethod, axes: tuple[int, ...] = (0, 1, 2)) -> float:
    """Return the highest frequency of a mesh as it stands, from forces upon motions of each node [1/ms]."""
    start = {name: rows.copy() for name, rows in method.state().items()}
    mass, small = method.nodes.mass, 1e-6
    free = [(n, a) for n in range(len(mass)) for a in axes if method.nodes.inverse_mass[n, a] > 0.0]
    rows, stiffness = tuple(np.transpose(free)), np.zeros((len(free), len(free)))
    for number, place in enumerate(free):
        motion = np.zeros((len(mass), 3))
        for motion[place] in (small, -small):
            stiffness[number] -= answer(method, motion, 1.0)[rows] / (2.0 * motion[place])
            method.restore(start)
    root = np.sqrt(mass[rows[0]])
    return float(np.sqrt(np.linalg.eigvalsh(stiffness / np.outer(root, root)).max()))


def fitted(times: Array, signal: Array, roots: Any) -> complex:
    """Return the exponent that rings of a sum of exponentials that fits best; the search starts at ``roots``."""
    scale = np.abs(roots).max()
    fading = [float(root.real) for root in roots if root.imag == 0 and root.real != 0]
    ringing = complex(roots[roots.imag.argmax()])

    def residual(at: Array) -> Array:
        wave = np.exp((at[0] + 1j * at[1]) * scale * times)
        terms = np.column_stack([wave.real, wave.imag, *[np.exp(rate * scale * times) for rate in at[2:]]])
        return signal - terms @ np.linalg.lstsq(terms, signal, rcond=None)[0]

    start = np.array([ringing.real, ringing.imag, *fading]) / scale
    found = least_squares(residual, start, ftol=1e-15, xtol=1e-15, gtol=1e-15).x * scale
    return complex(found[0], found[1])


def assert_strained_as_a_material_point(
    method: FiniteElementMethod, state: State, force: Array, inner: NDArray[np.bool_], rounding: float, size: float
) -> None:
    """All points have its stress and J, and their ``force`` is nil on inner nodes, up to the share ``rounding``.

    ``size`` is that of the areas on which stress pulls there [mm^2].
    """
    found = method.elements.material.stress.reshape(-1, 6)
    stress = [getattr(state.stress, name) for name in COMPONENTS]
    assert_allclose(found, np.broadcast_to(stress, found.shape), rtol=0, atol=rounding * ELASTIC.p_wave_modulus)
    assert_allclose(method.elements.shared.jacobian, state.jacobian, rtol=rounding)
    assert np.abs(force[~inner]).max() > 1.0  # N
    assert_allclose(force[inner], 0.0, atol=size * rounding * ELASTIC.p_wave_modulus)
