"""What a step must keep: momentum, energy, freedom after contact; and that no bit depends on the threads.

Bounds "to rounding" allow for ``ROUNDING`` per step, some hundred roundings of the sums over a few hundred nodes.
"""

from typing import Any

import numba
import numpy as np
import pytest
from bricks import (
    ELASTIC,
    ELEMENTS,
    EPS,
    ON_WALL,
    Array,
    brick,
    column,
    each_element,
    fem,
    layers,
    missing,
    upward,
)
from columns import LENGTH, advance, one_thread, order, viscoelastic  # noqa: F401
from fronts import HALF
from numpy.testing import assert_allclose, assert_array_equal

from viscopoint.interactions.planes import rigid_wall, symmetry_plane
from viscopoint.kernels.arrays import Real
from viscopoint.methods.fem.elements import Element
from viscopoint.methods.fem.method import FiniteElementMethod
from viscopoint.methods.fem.rod import rod_mesh
from viscopoint.model.body import Body

pytestmark = pytest.mark.usefixtures("one_thread")
RELAXING = viscoelastic(65.0)
THREADS = numba.get_num_threads()
ROUNDING = 100 * EPS
PULSE = (0.06, 1.5)  # bulk viscosity as in impacts
ROD = rod_mesh(2.0, 6.0, 1.0)


def stirred(position: Array) -> Array:
    """Return random velocities on top of a stretch, a spin and a flight."""
    x, y, z = position.T
    smooth = np.column_stack([9 * x - 5 * y, 5 * x + 7 * y, 11 * (z - 3)])
    return smooth + np.random.default_rng(4).normal(size=position.shape) + [3.0, -2.0, 4.0]


def steps(method: FiniteElementMethod, count: int) -> FiniteElementMethod:
    for _ in range(count):
        method.advance(method.stable_step())
    return method


def spin(method: FiniteElementMethod) -> Array:
    """Return the angular momentum about the origin."""
    nodes = method.nodes
    return np.cross(nodes.position, nodes.mass[:, None] * nodes.velocity).sum(axis=0)


def impact(
    element: Element, friction: float = 0.1, body: Body = ROD, law: Any = RELAXING, real: Real = np.float64
) -> FiniteElementMethod:
    return fem(body, element, law, (rigid_wall(0.0, friction),), (20.0, 5.0, -100.0), viscosity=PULSE, real=real)


# --- momentum ---


@each_element
def test_linear_and_angular_momentum_are_kept_without_a_wall(element: Element) -> None:
    """Angular momentum too, to rounding: forces are those of a symmetric stress where the nodes are, kicks are at rest.

    The hourglass controls push the modes less what the mean gradient explains, and so have no moment either.
    """
    method, count = fem(ROD, element, RELAXING, (), stirred(ROD.position), viscosity=PULSE), 200
    start, turning = method.totals(), spin(method)
    steps(method, count)
    scale = count * ROUNDING * start.mass * np.abs(method.nodes.velocity).max()
    assert np.abs(method.elements.material.stress).max() > 0.1  # MPa: forces there were
    assert_array_equal(method.totals().impulse, 0.0)
    assert_allclose(method.totals().momentum, start.momentum, rtol=0, atol=scale)
    assert_allclose(spin(method), turning, rtol=0, atol=scale * 6.0)


@each_element
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_wall_impulse_is_the_change_of_momentum(element: Element, friction: float) -> None:
    method, count = impact(element, friction), 200
    start = method.totals()
    rounded = 10 * EPS * start.mass * 100.0  # of what has been pushed so far
    for _ in range(count):
        before = method.totals().impulse
        steps(method, 1)
        push = method.totals().impulse - before
        assert push[2] >= 0.0
        assert np.hypot(*push[:2]) <= friction * push[2] + rounded  # Coulomb's cone
    now = method.totals()
    scale = count * ROUNDING * start.mass * 100.0
    assert_allclose(now.momentum - start.momentum, now.impulse, rtol=0, atol=scale)
    assert now.impulse[2] > 0.1 * start.mass * 100.0
    assert (now.impulse[0] < 0.0) == (now.impulse[1] < 0.0) == (now.friction > 0.0) == (friction > 0.0)


@each_element
def test_quarter_between_mirrors_moves_as_the_whole(element: Element) -> None:
    velocity, size, foot = (0.0, 0.0, -50.0), (4.0, 4.0, 3.0), 0.01
    whole = fem(brick(size, (4, 4, 3), foot=foot), element, RELAXING, ON_WALL, velocity)
    quarter = brick((2.0, 2.0, 3.0), (2, 2, 3), foot=foot)
    quarter = quarter._replace(position=quarter.position + [1.0, 1.0, 0.0])
    part = fem(quarter, element, RELAXING, (*ON_WALL, symmetry_plane(0, 0.0), symmetry_plane(1, 0.0)), velocity)
    start, dt = part.totals(), part.stable_step() / 2
    for _ in range(80):
        whole.advance(dt)
        part.advance(dt)
    one, four = part.totals(), whole.totals()
    for name in ("kinetic", "stored", "dissipated", "contact"):
        assert_allclose(4 * getattr(one, name), getattr(four, name), rtol=1e-9)  # 80 steps of roundings, amplified
    assert_allclose(one.momentum - start.momentum, one.impulse, rtol=0, atol=80 * ROUNDING * start.mass * 50.0)
    assert np.abs(one.impulse[:2]).max() > 1e-3 * one.impulse[2]  # the mirrors push
    assert one.friction == 0.0  # and do no work


# --- contact ---


@each_element
def test_contact_is_made_exactly_when_the_foot_has_crossed_the_gap(element: Element) -> None:
    gap, speed, height = 0.0823, 40.0, -0.7
    body = brick((2.0, 2.0, 3.0), (2, 2, 3), foot=height + gap)
    method = fem(body, element, ELASTIC, (rigid_wall(height, 0.2),), (0.0, 0.0, -speed))
    start, dt, foot = method.totals(), method.stable_step(), body.surface.ring[0]
    free = int(gap / speed / dt)
    assert free > 1
    for _ in range(free):
        method.advance(dt)
        assert_array_equal(method.totals().impulse, 0.0)
    assert_allclose(method.nodes.position[foot, 2], height + gap - free * dt * speed, rtol=0, atol=free * EPS)
    method.advance(dt)
    assert_array_equal(method.nodes.position[foot, 2], height)
    assert_array_equal(method.nodes.velocity[foot, 2], 0.0)
    push, mass = float(method.totals().impulse[2]), method.nodes.mass[foot].sum()
    # what stops the foot, and half a step of the force of elements that are strained by less than v dt / h
    assert mass * speed <= push < mass * speed + 0.5 * dt * 4.0 * method.material.p_wave_modulus * speed * dt
    for _ in range(200):
        method.advance(dt)
        assert method.nodes.position[:, 2].min() >= height
    assert_allclose(method.totals().momentum - start.momentum, method.totals().impulse, atol=1e-12, rtol=0)


@each_element
def test_nodes_stand_on_the_wall_to_the_last_bit_and_none_passes_it(element: Element) -> None:
    # nodes come from far, compared with the height, which leaves their last bits to rounding
    body, height, pressed = brick((2.0, 2.0, 2.0), (2, 2, 2), foot=0.03), 1 / 3000, 0
    velocity = np.random.default_rng(6).normal(size=body.position.shape) * 20.0 - [0.0, 0.0, 50.0]
    method = fem(body, element, RELAXING, (rigid_wall(height, 0.1),), velocity)
    for _ in range(100):
        steps(method, 1)
        assert_array_equal(method.nodes.position[method.nodes.pressed > 0, 2], height)
        assert method.nodes.position[:, 2].min() >= height
        pressed += int(method.nodes.pressed.sum())
    assert pressed > 10


@each_element
@pytest.mark.parametrize("cells", [50, 100])
def test_elastic_column_rebounds_without_adhesion_or_gain(element: Element, cells: int) -> None:
    speed, sound = 1e-3, 858.293
    method = column(cells, element, ELASTIC, velocity=upward(lambda z: np.full_like(z, -speed)))
    start, times, pushes, energies = method.totals(), [0.0], [0.0], [0.0]
    while times[-1] < 3.5 * LENGTH / sound:
        dt = method.stable_step()
        method.advance(dt)
        now = method.totals()
        times.append(times[-1] + dt)
        pushes.append(float(now.impulse[2]))
        energies.append(now.kinetic + now.stored)
    assert np.diff(pushes).min() >= 0.0  # it never pulls
    assert max(energies) < start.kinetic
    # the half element at the foot stops, which is all that is lost; the energy of the front's shortest waves swings by
    # (w dt)^2 / 4 < C^2 in leapfrog steps, and they are in about as much of the column
    assert_allclose(energies[-1] / start.kinetic, 1 - 0.5 / cells, rtol=0, atol=0.5**2 * 0.5 / cells)
    # the front comes back as step(xi) and takes the wall's stress 1 - 2 step to nothing where step = 1/2
    h = LENGTH / cells
    w = float(np.cbrt(3 * (1 - 0.5**2) / 24 * h**2 * 2 * LENGTH))
    left = times[int(np.flatnonzero(np.diff(pushes))[-1]) + 1]
    assert_allclose(sound * left, 2 * LENGTH - HALF * w, rtol=0, atol=h / 2)  # its tail comes and goes with h
    assert layers(method, method.nodes.position[:, 2])[0] > 0.0


@each_element
def test_contact_takes_just_the_energy_of_the_foot_that_stops(element: Element) -> None:
    cells, speed = 50, 1.0
    method = column(cells, element, RELAXING, velocity=upward(lambda z: np.full_like(z, -speed)))
    start = method.totals().kinetic
    advance(method, 0.02)
    assert_allclose(method.totals().contact, start / (2 * cells), rtol=1e-12)
    assert method.totals().friction == 0.0


@each_element
def test_sliding_block_feels_coulomb_friction(element: Element) -> None:
    friction, speed = 0.2, 20.0
    walls = (rigid_wall(0.0, friction), symmetry_plane(1, -1.0), symmetry_plane(1, 1.0))
    method = fem(brick((4.0, 2.0, 3.0), (4, 2, 3)), element, ELASTIC, walls, (speed, 0.0, -1.0))
    for _ in range(10):
        before = method.totals().impulse
        steps(method, 1)
        push = method.totals().impulse - before
        assert push[2] > 0.0
        assert_allclose(push[0], -friction * push[2], rtol=1e-10)
    now = method.totals()
    # each bit of impulse works on nodes that still slide nearly at the speed of the start
    assert_allclose(now.friction, -now.impulse[0] * speed, rtol=0.05)


@each_element
def test_slow_block_sticks_and_no_more(element: Element) -> None:
    slide, speed, dt = 0.1, 10.0, 1e-9
    method = fem(brick((3.0, 3.0, 3.0), (3, 3, 3)), element, ELASTIC, (rigid_wall(0.0, 0.5),), (slide, 0.0, -speed))
    start = method.totals()
    method.advance(dt)
    foot = ELASTIC.density * 9.0 / 2  # half an element's height of it
    # and half a step of the force of elements strained by v dt / h: less by c^2 dt^2 / h^2
    assert_allclose(method.totals().impulse, [-foot * slide, 0.0, foot * speed], rtol=1e-10, atol=1e-14)
    assert_allclose(
        [method.totals().contact, method.totals().friction], foot / 2 * np.square([speed, slide]), rtol=1e-8
    )
    assert abs(missing(start, method.totals())) < 1e-10


# --- energy ---


def shaken(element: Element, law: Any, safety: float, viscosity: tuple[float, float] = (0.0, 0.0)) -> float:
    """Return what is missing of a block's energy after some vibration."""
    body = brick((4.0, 3.0, 5.0), (4, 3, 5), shake=0.15)
    x, y, z = body.position.T / 4.0
    motion = 1e-3 * np.column_stack([np.sin(2 * z) + x, np.cos(3 * x), np.sin(2 * x + y) - z])
    method = fem(body, element, law, (), motion, safety, viscosity)
    start = method.totals()
    advance(method, 0.02)
    return missing(start, method.totals())


@each_element
@pytest.mark.parametrize("law", [ELASTIC, RELAXING], ids=["elastic", "viscoelastic"])
@pytest.mark.parametrize("viscosity", [(0.0, 0.0), (0.6, 1.5)], ids=["plain", "bulk-viscous"])
def test_energy_of_a_small_vibration_closes_to_second_order_in_the_time_step(
    element: Element, law: Any, viscosity: tuple[float, float]
) -> None:
    errors = [shaken(element, law, safety, viscosity) for safety in (0.8, 0.4, 0.2)]
    # waves of the mesh's length swing in their own phase: what they add is up to a tenth of an order
    assert_allclose(order(np.abs(errors).tolist()), 2.0, atol=0.1)
    assert abs(errors[0]) < 0.8**2 / 4  # leapfrog's swing of the shortest waves


# --- bits ---


def assert_same_bits(one: dict[str, Any], other: dict[str, Any]) -> None:
    assert one.keys() == other.keys()
    for name, values in one.items():
        assert_array_equal(values, other[name], err_msg=name)


@pytest.mark.parametrize(
    ("element", "real"),
    [
        *((element, np.float64) for element in ELEMENTS.values()),
        pytest.param(ELEMENTS["stiffness"], np.float32, marks=pytest.mark.long),
    ],
    ids=[*ELEMENTS, "single"],
)
def test_thread_count_changes_no_bit(element: Element, real: Real) -> None:
    if THREADS < 2:
        pytest.skip("one core")
    states = []
    for threads in (1, 2):
        numba.set_num_threads(threads)
        method = steps(impact(element, body=rod_mesh(2.0, 6.0, 0.5), real=real), 40)
        totals = method.totals()
        states.append({**method.state(), "totals": np.hstack(totals)})
    assert_same_bits(*states)


@each_element
def test_restored_run_goes_on_bit_for_bit(element: Element) -> None:
    straight, resumed = steps(impact(element), 20), impact(element)
    resumed.restore(straight.state())
    assert resumed.stable_step() == straight.stable_step()
    assert_same_bits(steps(straight, 20).state(), steps(resumed, 20).state())
    assert_array_equal(np.hstack(straight.totals()), np.hstack(resumed.totals()))
