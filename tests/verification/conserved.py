"""What a step must keep whatever the method: momentum, energy, freedom after contact, every bit.

Bounds "to rounding" allow for ``ROUNDING`` per step, some hundred roundings of sums over a few hundred nodes or points.
"""

from collections.abc import Callable
from typing import Any, TypeVar

import numba
import numpy as np
import pytest
from columns import LENGTH, Array, advance, viscoelastic
from fronts import HALF
from numpy.testing import assert_allclose, assert_array_equal

from viscopoint.methods.fem.method import FiniteElementMethod
from viscopoint.methods.tlmpm.method import TotalLagrangianMethod
from viscopoint.model.method import Method, Totals

AnyMethod = TypeVar("AnyMethod", bound=Method)
LagrangianMethod = FiniteElementMethod | TotalLagrangianMethod
RELAXING = viscoelastic(65.0)
THREADS = numba.get_num_threads()
EPS = np.finfo(float).eps
ROUNDING = 100 * EPS
SOUND = 858.293  # of the elastic column, mm/ms


def stirred(position: Array, middle: float = 3.0) -> Array:
    """Return random velocities on top of a stretch and a spin around a height, and a flight."""
    x, y, z = position.T
    smooth = np.column_stack([9 * x - 5 * y, 5 * x + 7 * y, 11 * (z - middle)])
    return smooth + np.random.default_rng(4).normal(size=position.shape) + [3.0, -2.0, 4.0]


def trembling(position: Array) -> Array:
    """Return the velocities of a small vibration."""
    x, y, z = position.T / 4.0
    return 1e-3 * np.column_stack([np.sin(2 * z) + x, np.cos(3 * x), np.sin(2 * x + y) - z])


def steps(method: AnyMethod, count: int) -> AnyMethod:
    """Take stable steps."""
    for _ in range(count):
        method.advance(method.stable_step())
    return method


def missing(start: Totals, now: Totals) -> float:
    """Return the share of the initial energy that no account holds."""
    return 1 - now.energy / start.energy


def missing_after(method: Method, time: float = 0.02) -> float:
    """Return what is missing after some time [ms]."""
    start = method.totals()
    advance(method, time)
    return missing(start, method.totals())


# --- momentum ---


def spin(method: LagrangianMethod) -> Array:
    """Return the angular momentum about the origin."""
    nodes = method.nodes
    return np.cross(nodes.position, nodes.mass[:, None] * nodes.velocity).sum(axis=0)


def assert_free_flight_keeps_both_momenta(method: LagrangianMethod, count: int = 200) -> None:
    """Of a body ``stirred``, 6 mm long; angular momentum too, to rounding."""
    start, turning = method.totals(), spin(method)
    steps(method, count)
    scale = count * ROUNDING * start.mass * np.abs(method.nodes.velocity).max()
    assert np.abs(method.states()[0].stress).max() > 0.1  # MPa: forces there were
    assert_array_equal(method.totals().impulse, 0.0)
    assert_allclose(method.totals().momentum, start.momentum, rtol=0, atol=scale)
    assert_allclose(spin(method), turning, rtol=0, atol=scale * 6.0)


def assert_wall_impulse_is_the_change_of_momentum(method: Method, friction: float, count: int = 200) -> None:
    """Of a body that comes at (20, 5, -100) mm/ms."""
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


# --- contact ---


def assert_contact_is_made_when_the_gap_is_crossed(
    method: LagrangianMethod, foot: Any, height: float, gap: float, speed: float
) -> tuple[float, float]:
    """Let nodes ``foot`` come to a wall at ``height``; return the impulse that stops them, and the step it takes."""
    start, dt, nodes = method.totals(), method.stable_step(), method.nodes
    free = int(gap / speed / dt)
    assert free > 1
    for _ in range(free):
        method.advance(dt)
        assert_array_equal(method.totals().impulse, 0.0)
        assert_allclose(method.states()[0].stress, 0.0, atol=1e-9)
    assert_allclose(nodes.position[foot, 2], height + gap - free * dt * speed, rtol=0, atol=free * EPS)
    method.advance(dt)
    assert_array_equal(nodes.position[foot, 2], height)
    assert_array_equal(nodes.velocity[foot, 2], 0.0)
    push = float(method.totals().impulse[2])
    assert push > 0.0
    for _ in range(200):
        method.advance(dt)
        assert nodes.position[:, 2].min() >= height
        assert method.positions()[:, 2].min() >= height - 10 * EPS
    assert_allclose(method.totals().momentum - start.momentum, method.totals().impulse, atol=1e-12, rtol=0)
    return push, dt


def assert_slides_by_coulomb(method: Method, friction: float, speed: float) -> None:
    """Of a block that is pressed on the wall at 1 mm/ms and slides at ``speed``."""
    for _ in range(10):
        before = method.totals().impulse
        steps(method, 1)
        push = method.totals().impulse - before
        assert push[2] > 0.0
        assert_allclose(push[0], -friction * push[2], rtol=1e-10)
    now = method.totals()
    # each bit of impulse works on nodes that still slide nearly at the speed of the start
    assert_allclose(now.friction, -now.impulse[0] * speed, rtol=0.05)


def assert_rebounds_without_adhesion(
    method: LagrangianMethod, cells: int, dispersion: float, late: float
) -> tuple[Array, Totals]:
    """Let an elastic column of some cells bounce; return its greatest and last energy over the first, and the totals.

    The front comes back as step(xi) and takes the wall's stress 1 - 2 step to nothing where step = 1/2: it leaves then,
    up to ``late`` cells.
    """
    start = now = method.totals()
    times, pushes, energies = [0.0], [0.0], [0.0]
    while times[-1] < 3.5 * LENGTH / SOUND:
        dt = method.stable_step()
        method.advance(dt)
        now = method.totals()
        times.append(times[-1] + dt)
        pushes.append(float(now.impulse[2]))
        energies.append(now.kinetic + now.stored)
    assert np.diff(pushes).min() >= 0.0  # it never pulls
    h = LENGTH / cells
    w = float(np.cbrt(3 * dispersion * h**2 * 2 * LENGTH))
    left = times[int(np.flatnonzero(np.diff(pushes))[-1]) + 1]
    assert_allclose(SOUND * left, 2 * LENGTH - HALF * w, rtol=0, atol=late * h)
    return np.array([max(energies), energies[-1]]) / start.kinetic, now


# --- bits ---


def assert_same_bits(one: dict[str, Any], other: dict[str, Any]) -> None:
    assert one.keys() == other.keys()
    for name, values in one.items():
        assert_array_equal(values, other[name], err_msg=name)


def assert_thread_count_changes_no_bit(state: Callable[[], dict[str, Any]]) -> None:
    """Of what a run leaves, on one thread and on two."""
    if THREADS < 2:
        pytest.skip("one core")
    states = []
    for threads in (1, 2):
        numba.set_num_threads(threads)
        states.append(state())
    assert_same_bits(*states)


def assert_restored_run_goes_on_bit_for_bit(make: Callable[[], Method], count: int = 20) -> None:
    straight, resumed = steps(make(), count), make()
    resumed.restore(straight.state())
    assert resumed.stable_step() == straight.stable_step()
    assert_same_bits(steps(straight, count).state(), steps(resumed, count).state())
    assert_array_equal(np.hstack(straight.totals()), np.hstack(resumed.totals()))
