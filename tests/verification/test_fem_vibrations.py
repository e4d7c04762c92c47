"""A bar held at its foot and free at its rear, ringing as sin(kz), k = pi/2L (shared reference: verification.md, 7).

Of a standard linear solid the modes solve s^2 (s + b) + w0^2 (s + a) = 0 with w0 = c0 k: for a column M(t) and beta,
for a thin rod E(t) and b. A shift of w0 shifts s by ds = sensitivity s dw0/w0. Elements of size h shift w0/w0 by

    column:  -(kh)^2 (1 - C^2) / 24
    rod:     -(kh)^2 [1/24 - (C c0/c)^2 / 24 + nu^2 / 4 - X],    cubes, one across

nu^2/4 is lateral inertia (Love 1944) of nodes at half the width. X is what resists lateral motion that varies along an
element: nothing for the viscous control, a spring's coefficient M nu^2 / 16E for the stiffness control, and of eight
points G nu^2 / E (1/12 + 1/18), for shear (Bishop 1952) and for lateral strain that varies while the axial does not.
"""

from collections.abc import Callable
from typing import Any

import laplace
import numpy as np
import pytest
from bricks import DISPERSION, ELEMENTS, Array, bar, column, fitted, layers
from columns import BULK, COURANT, DENSITY, LENGTH, MODULI, SHEAR_LONG, SHEAR_SHORT, one_thread, order, viscoelastic  # noqa: F401
from laplace import StandardSolid
from numpy.testing import assert_allclose

from viscopoint.interactions.planes import symmetry_plane
from viscopoint.methods.fem.method import FiniteElementMethod

pytestmark = pytest.mark.usefixtures("one_thread")
SPEED = 1e-4  # mm/ms: strains of 1e-7, what is not linear is of that size
STRAIN = SPEED / 858.293
MESHES = (16, 32, 64)
YOUNG = 9 * BULK * SHEAR_SHORT / (3 * BULK + SHEAR_SHORT)
MODULUS = BULK + 4 * SHEAR_SHORT / 3
POISSON = (3 * BULK - 2 * SHEAR_SHORT) / (2 * (3 * BULK + SHEAR_SHORT))
RESISTED = {
    "viscous": 0.0,
    "stiffness": 0.05 * MODULUS / YOUNG * POISSON**2 / 16,
    "selective": SHEAR_SHORT / YOUNG * POISSON**2 * (1 / 12 + 1 / 18),
}
each_name = pytest.mark.parametrize("name", ELEMENTS)


def ringing(make: Any, name: str, decay: float, cells: int, waves: int = 1) -> FiniteElementMethod:
    """Return a bar that starts to ring, its sides as the instantaneous response has them."""
    k, lateral = waves * np.pi / (2 * LENGTH), POISSON if make is bar else 0.0

    def motion(position: Array) -> Array:
        x, y, z = position.T
        swell = -lateral * k * np.cos(k * z)
        return SPEED * np.column_stack([swell * x, swell * y, np.sin(k * z)])

    return make(cells, ELEMENTS[name], viscoelastic(decay), (symmetry_plane(2, 0.0),), velocity=motion)


def history(method: FiniteElementMethod, waves: int, samples: int, every: int) -> tuple[Array, Array]:
    """Return times and the mode's velocity there."""
    mode = np.sin(waves * np.pi / (2 * LENGTH) * layers(method, method.body.position[:, 2]))
    weight = mode / (mode @ mode - 0.5 * mode[-1] ** 2) / SPEED
    weight[-1] /= 2  # half a node's mass
    found: list[float] = []
    dt = method.stable_step()
    for sample in range(samples + 1):
        for _ in range(every if sample else 0):
            method.advance(dt)
        found.append(float(layers(method, method.nodes.velocity[:, 2]) @ weight))
    return np.linspace(0.0, samples * every * dt, samples + 1), np.array(found)


# --- the chain ---


def chain(decay: float, k: float, cell: float, dt: float, steps: int) -> Array:
    """Return the velocity of a mode of masses and springs by velocity Verlet, starting at 1."""
    slope, v, spring, arm, found = 2 / cell * np.sin(k * cell / 2), 1.0, 0.0, 0.0, [1.0]
    left = np.exp(-decay * dt)
    grown = (1 - left) / decay if decay else dt
    for _ in range(steps):
        v -= 0.5 * dt / DENSITY * slope * (spring + arm)
        spring += (BULK + 4 * SHEAR_LONG / 3) * dt * slope * v
        arm = left * arm + 4 * (SHEAR_SHORT - SHEAR_LONG) / 3 * grown * slope * v
        v -= 0.5 * dt / DENSITY * slope * (spring + arm)
        found.append(v)
    return np.array(found)


@each_name
@pytest.mark.parametrize("decay", [0.0, 6.5, 65.0, 650.0])
@pytest.mark.parametrize("waves", [1, 5])
def test_column_is_a_chain_of_masses_and_springs(name: str, decay: float, waves: int) -> None:
    cells, steps, k = 8, 100, waves * np.pi / (2 * LENGTH)
    method = ringing(column, name, decay, cells, waves)
    times, found = history(method, waves, steps, 1)
    # each step may turn the phase by the strain times w dt < 1
    assert_allclose(found, chain(decay, k, LENGTH / cells, times[1], steps), rtol=0, atol=steps * STRAIN)
    if not decay:
        turn = 2 * np.arcsin(COURANT * np.sin(k * LENGTH / cells / 2))
        assert_allclose(found, np.cos(turn * np.arange(steps + 1)), rtol=0, atol=steps * STRAIN)


# --- frequency and damping ---


def exponents(solid: StandardSolid) -> tuple[Any, complex, float]:
    """Return the exact exponents [1/ms], the one that rings, and |ds/s| per dw0/w0."""
    square = (np.pi / (2 * LENGTH) * solid.speed) ** 2
    roots = np.roots([1.0, solid.decay, square, square * solid.a])
    s = complex(roots[roots.imag.argmax()])
    return roots, s, abs(2 * square * (s + solid.a) / (3 * s**2 + 2 * s * solid.decay + square) / s)


def shifts(make: Any, solid: StandardSolid, name: str, decay: float) -> list[complex]:
    """Return ds / (s sensitivity (kh)^2) of each mesh over one period: the coefficients of the table above."""
    roots, exact, sensitivity = exponents(solid)
    found = []
    for cells in MESHES:
        method = ringing(make, name, decay, cells)
        every = cells // 8
        samples = int(2 * np.pi / exact.imag / method.stable_step() / every)
        s = fitted(*history(method, 1, samples, every), roots)
        found.append((s - exact) / (abs(exact) * sensitivity * (np.pi / 2 / cells) ** 2))
    return found


def second_order(shift: list[complex]) -> float:
    """Return the order of the error of s, whose coefficients with (kh)^2 are given."""
    return 2.0 + order([abs(s) for s in shift])


BARS: dict[str, tuple[Any, Callable[..., StandardSolid]]] = {
    "column": (column, laplace.confined),
    "rod": (bar, laplace.thin),
}


@pytest.mark.parametrize(("kind", "decay", "rounded"), [
    ("rod", 6.5, -2888.7 + 38353.1j), ("rod", 65.0, -28758.9 + 22476.2j), ("rod", 650.0, -1188.8 + 7483.8j),
])  # fmt: skip
def test_exponents_are_the_tabulated_ones(kind: str, decay: float, rounded: complex) -> None:
    assert_allclose(1e3 * exponents(BARS[kind][1](*MODULI, decay))[1], rounded, rtol=0, atol=0.08)


@each_name
@pytest.mark.parametrize("kind", BARS)
def test_elastic_bar_rings_lower_by_exactly_its_dispersion_and_lateral_inertia(kind: str, name: str) -> None:
    make, exact = BARS[kind]
    solid = exact(*MODULI, 0.0)
    found = shifts(make, solid, name, 0.0)
    ratio = COURANT * solid.speed / 858.293
    lateral = POISSON**2 / 4 - RESISTED[name] if kind == "rod" else 0.0
    # the next terms of either series are (kh)^2 < 1 % of these on the coarsest mesh
    assert_allclose([s.imag for s in found], -(1 - ratio**2) / 24 - lateral, rtol=0.01)
    # the viscous control works on q' = nu h^2 k / 4 times the strain rate: it damps by Q (c/c0) nu^2 (kh)^3 per radian
    damping = 0.1 * 858.293 / solid.speed * POISSON**2 if name == "viscous" and kind == "rod" else 0.0
    size = np.pi / 2 / np.array(MESHES)
    assert_allclose([s.real for s in found] * size**2, -damping * size**3, rtol=0.01, atol=STRAIN)
    assert_allclose(second_order(found), 2.0, atol=0.01)


@each_name
@pytest.mark.parametrize("decay", [6.5, 65.0, 650.0])
def test_viscoelastic_column_rings_and_damps_as_the_standard_solid(name: str, decay: float) -> None:
    found = shifts(column, laplace.confined(*MODULI, decay), name, decay)
    assert_allclose(np.abs(found), DISPERSION, rtol=0.02)
    assert_allclose(second_order(found), 2.0, atol=0.02)


@each_name
@pytest.mark.parametrize("decay", [6.5, 65.0, 650.0])
def test_viscoelastic_rod_rings_and_damps_as_the_standard_solid(name: str, decay: float) -> None:
    found = shifts(bar, laplace.thin(*MODULI, decay), name, decay)
    # nu goes from 0.38 to 0.496, and E to 15 MPa, against which the stiffness control is an elastic spring; where s is
    # complex what elements and steps do need not cancel
    spring = 0.05 * MODULUS / 14.95468 * 0.496**2 / 16
    allowed = (1 + COURANT**2) / 24 + 1 / 16 + (spring if name == "stiffness" else 0.0)
    assert np.abs(found).max() < allowed
    assert_allclose(second_order(found), 2.0, atol=0.05)
