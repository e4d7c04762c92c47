"""Axisymmetric finite elements: uniform strain, waves along and across, conservation, the stable step.

The meshes' inner nodes are moved at random by up to a fifth of an element where a test says "distorted".
"""

from typing import Any

import bricks
import laplace
import numpy as np
import pytest
from bricks import ELASTIC, ELEMENTS, answer, each_element, fitted, highest, upward
from columns import BULK, DENSITY, LENGTH, MODULI, SHEAR_SHORT, one_thread, order, viscoelastic  # noqa: F401
from conserved import RELAXING, ROUNDING, missing_after
from material_point import at_rest, moved
from numpy.testing import assert_allclose, assert_array_equal
from rings import PLANE, fem, outside, section
from scipy.optimize import root_scalar
from scipy.special import j0, j1

from viscopoint.interactions.planes import rigid_wall, symmetry_plane
from viscopoint.materials import step_factors
from viscopoint.materials.linear_viscoelastic import LinearViscoelastic
from viscopoint.methods.fem.elements import Element
from viscopoint.methods.fem.section import section_mesh
from viscopoint.model.body import Body

pytestmark = pytest.mark.usefixtures("one_thread")
MODULUS = ELASTIC.p_wave_modulus
SOUND = float(np.sqrt(MODULUS / DENSITY))
SLOW = 1e-5  # mm/ms
PULSE = (0.06, 1.5)  # bulk viscosity as in impacts


def distorted() -> Body:
    return section(3.0, 5.0, 4, 6, shake=0.15)


# --- uniform strain ---


@each_element
def test_patch_of_distorted_rings_has_the_stress_of_a_material_point(element: Element) -> None:
    method, dt, state = fem(distorted(), element, RELAXING), 0.01, at_rest(RELAXING)
    inner = ~outside(method.body.position)
    for number, (wide, high) in enumerate([(0.2, -0.15), (-0.1, 0.1), (0.05, 0.2), (0.1, -0.2)], start=1):
        gradient = np.diag([wide, wide, high])
        force = answer(method, method.nodes.position @ gradient / dt + [0.0, 0.0, 5.0], dt)
        state = moved(RELAXING, step_factors(RELAXING, dt), state, gradient)
        # on rings of up to 2 pi 3 mm x 1 mm
        bricks.assert_strained_as_a_material_point(method, state, force, inner, number * ROUNDING, size=100.0)
        assert_array_equal(force[:, 1], 0.0)
    assert_allclose(method.elements.material.dissipated, state.dissipated, rtol=10 * ROUNDING)
    assert_allclose(method.elements.hourglass_work, 0.0, atol=10 * ROUNDING)


@each_element
def test_rings_have_the_volume_and_the_mass_of_the_rod(element: Element) -> None:
    method = fem(distorted(), element)
    assert_allclose(method.elements.volume.sum(), np.pi * 3.0**2 * 5.0, rtol=ROUNDING)
    assert_allclose(method.totals().mass, DENSITY * np.pi * 3.0**2 * 5.0, rtol=ROUNDING)
    assert method.nodes.mass.min() > 0.0


# --- across: breathing ---


def breathing(element: Element, columns: int) -> float:
    """Return the frequency of a long cylinder in units of the exact one.

    Held along z, u_r = J1(x r / R) with x = omega R / c; the mantle is free of stress where
    x J0(x) = (1 - 2 nu) / (1 - nu) J1(x) (Love 1944, section 196).
    """
    poisson = (3 * BULK - 2 * SHEAR_SHORT) / (2 * (3 * BULK + SHEAR_SHORT))
    x = root_scalar(lambda x: x * j0(x) - (1 - 2 * poisson) / (1 - poisson) * j1(x), bracket=(1.0, 3.0)).root
    radius, exact = 4.0, x * SOUND / 4.0
    body = section(radius, radius / columns, columns, 1)
    mode = np.outer(j1(x * body.position[:, 0] / radius), [1.0, 0.0, 0.0])
    ends = (symmetry_plane(2, 0.0), symmetry_plane(2, radius / columns))
    method = fem(body, element, ELASTIC, ends, SLOW * mode, safety=0.8)
    weight = method.nodes.mass[:, None] * mode
    weight /= SLOW * (weight * mode).sum()
    steps, dt, signal = 12 * columns, method.stable_step(), [1.0]
    for _ in range(steps):
        method.advance(dt)
        signal.append(float((method.nodes.velocity * weight).sum()))
    found = fitted(np.linspace(0.0, steps * dt, steps + 1), np.array(signal), np.array([1j * exact]))
    return found.imag / exact


@pytest.mark.parametrize("name", ELEMENTS)
def test_long_cylinder_breathes_at_its_exact_frequency_to_second_order(name: str) -> None:
    errors = [abs(breathing(ELEMENTS[name], columns) - 1) for columns in (4, 8, 16)]
    assert_allclose(order(errors), 2.0, atol=0.1)
    assert errors[0] < (2.1 / 4) ** 2 / 24  # what lumped masses alone shift, and the step puts half of it back


# --- along: the confined column ---


@pytest.mark.parametrize("name", ELEMENTS)
@pytest.mark.parametrize("decay", [65.0, 650.0])
def test_column_of_rings_between_rollers_moves_as_one_of_cubes(name: str, decay: float) -> None:
    """And cubes are a chain of masses and springs, which is compared with exact solutions (test_fem_waves)."""
    cells, law, speed = 50, viscoelastic(decay), 1e-4
    side = LENGTH / cells
    falling = np.array([0.0, 0.0, -speed])
    rings = fem(
        section(2 * side, LENGTH, 2, cells),
        ELEMENTS[name],
        law,
        (rigid_wall(0.0, 0.0), symmetry_plane(0, 2 * side)),
        falling,
    )
    cubes = bricks.column(cells, bricks.SELECTIVE, law, velocity=upward(lambda z: np.full_like(z, -speed)))
    steps, dt = 100, 0.02 / 100
    for _ in range(steps):
        rings.advance(dt)
        cubes.advance(dt)
    layers = rings.nodes.velocity[:, 2].reshape(cells + 1, 3)
    exact = bricks.layers(cubes, cubes.nodes.velocity[:, 2])
    strain = 2e-7  # what is not linear
    assert_allclose(layers / speed, np.repeat(exact[:, None] / speed, 3, axis=1), rtol=0, atol=steps * strain)
    push, area = float(rings.totals().impulse[2]), np.pi * (2 * side) ** 2
    assert_allclose(push / area, float(cubes.totals().impulse[2]) / bricks.area(cubes), rtol=steps * strain)
    solid = laplace.confined(*MODULI, decay)
    tau = 2 * solid.speed * 0.02 / side  # a chain's faint ringing, see test_fem_waves
    faint = np.sqrt(1 / (2 * np.pi)) * tau**-1.5 * DENSITY * speed * side
    assert_allclose(push / area, laplace.wall_impulse(solid, LENGTH, speed, 0.02), rtol=0, atol=faint)


# --- conservation ---


@each_element
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_wall_impulse_is_the_change_of_momentum_along_the_axis(element: Element, friction: float) -> None:
    body, count = section_mesh(2.0, 6.0, 0.5), 200
    method = fem(body, element, RELAXING, (rigid_wall(0.0, friction),), (0.0, 0.0, -100.0), viscosity=PULSE)
    start = method.totals()
    for _ in range(count):
        method.advance(method.stable_step())
    now = method.totals()
    scale = count * ROUNDING * start.mass * 100.0
    assert_allclose(now.momentum - start.momentum, now.impulse, rtol=0, atol=scale)
    assert_array_equal(now.impulse[:2], 0.0)
    assert now.impulse[2] > 0.1 * start.mass * 100.0
    assert (now.friction > 0.0) == (friction > 0.0)
    assert_array_equal(method.nodes.position[body.position[:, 0] == 0.0, 0], 0.0)
    assert_array_equal(method.nodes.position[:, 1], 0.0)
    assert method.nodes.position[body.surface.ring[0, 0], 0] > 2.0


def shaken(element: Element, law: Any, safety: float, viscosity: tuple[float, float]) -> float:
    """Return what is missing of a rod's energy after some vibration."""
    body = distorted()
    x, _, z = body.position.T / 3.0
    motion = 1e-3 * np.column_stack([x * np.sin(2 * z) + x**2, 0 * x, np.sin(2 * x**2) - z * x])
    return missing_after(fem(body, element, law, (), motion, safety=safety, viscosity=viscosity))


@each_element
@pytest.mark.parametrize("viscosity", [(0.0, 0.0), (0.6, 1.5)], ids=["plain", "bulk-viscous"])
def test_energy_of_a_small_vibration_closes_to_second_order_in_the_time_step(
    element: Element, viscosity: tuple[float, float]
) -> None:
    errors = [shaken(element, RELAXING, safety, viscosity) for safety in (0.9, 0.45, 0.225)]
    # waves of the mesh's length swing in their own phase: what they add is up to a fifth of an order
    assert_allclose(order(np.abs(errors).tolist()), 2.0, atol=0.2)
    assert abs(errors[0]) < 0.9**2 / 4  # leapfrog's swing of the shortest waves


# --- the stable step ---


BODIES: dict[str, Body] = {
    "squares": section(2.0, 3.0, 2, 3),
    "distorted": section(2.0, 3.0, 4, 3, shake=0.1),
    "flat": section(2.0, 1.0, 3, 3),
    "tall": section(1.0, 6.0, 3, 4),
    "one column": section(1.0, 3.0, 1, 3),
}


@each_element
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES.keys())
@pytest.mark.parametrize("shear", [0.1, 140.0, 5e4])  # MPa; K = 550
def test_stable_step_is_safe_also_beside_the_axis(element: Element, body: Body, shear: float) -> None:
    law = LinearViscoelastic(DENSITY, BULK, shear, 0.0, 0.0)
    critical = 2.0 / highest(fem(body, element, law), PLANE)
    found = fem(body, element, law, safety=1.0).stable_step()
    # a sum over corners where the highest mode takes the largest of some, each with a half of c² at most
    assert 0.5 * critical < found <= critical * (1 + 1e-4)


@each_element
def test_ring_turned_inside_out_allows_no_step_and_is_named(element: Element) -> None:
    method = fem(section(1.0, 3.0, 1, 3), element)
    answer(method, upward(lambda z: np.where(z > 2.5, -1.5, 0.0))(method.body.position), 1.0)
    assert method.stable_step() == 0.0
    assert method.limiting_element() == "element 2, at (0.5, 0, 1.75) mm, is turned inside out"
