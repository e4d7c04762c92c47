"""What the wall takes from nodes that come to it unevenly, under forces: all that they lose, and no momentum unseen."""

from typing import Any

import bricks
import columns
import lagrangian
import numpy as np
import pytest
from columns import ELASTIC, Array, one_thread  # noqa: F401
from conserved import ROUNDING, steps
from numpy.testing import assert_allclose

from viscopoint.interactions.on_nodes import correct_velocity
from viscopoint.interactions.planes import rigid_wall, symmetry_plane
from viscopoint.interactions.rows import NORMAL_WORK, empty_rows, solve
from viscopoint.methods.lagrangian import LagrangianBody

pytestmark = pytest.mark.usefixtures("one_thread")
WALL, DT = rigid_wall(0.0, 0.0), 1e-4


def disturbed(nodes: Any) -> None:
    """Give nodes uneven velocities down, and forces that change them by a tenth in half a step."""
    rng = np.random.default_rng(8)
    nodes.velocity[:] = rng.normal(size=nodes.velocity.shape) - [0.0, 0.0, 30.0]
    nodes.force[:] = nodes.mass[:, None] / (0.5 * DT) * 3.0 * rng.normal(size=nodes.force.shape)


def set_off(method: LagrangianBody) -> Array:
    """Begin a step, up to where the wall has acted; return what it did (``rows.REACTIONS``)."""
    method.kick(DT)
    rows = method.constrain(empty_rows(0), 0, 0, DT)
    solve(rows, 0, int(rows.size[0]), method.reactions)
    correct_velocity(method.nodes, rows, 0)
    (done,) = method.reactions
    return done


def upright_energy(nodes: Any, stopped: Array) -> float:
    return float(0.5 * (nodes.mass * nodes.velocity[:, 2] ** 2)[stopped].sum())


def test_wall_takes_all_that_the_nodes_lose_which_it_stops() -> None:
    """Of elements; what the force did to a node in that half step is in it, or no account would have it."""
    method = bricks.fem(bricks.brick((2.0, 2.0, 2.0), (2, 2, 2)), bricks.SELECTIVE, ELASTIC, (WALL,))
    nodes = method.nodes
    disturbed(nodes)
    stopped = nodes.position[:, 2] == 0.0
    before = upright_energy(nodes, stopped)
    done = set_off(method)
    assert (nodes.in_contact[stopped] > 0).all()
    assert before > 0.0
    assert_allclose(done[NORMAL_WORK], upright_energy(nodes, stopped) - before, rtol=1e-12)


def test_wall_takes_all_that_nodes_beside_the_foot_lose() -> None:
    """The same of total Lagrangian points, where no node stands above to take the momentum."""
    method = lagrangian.brick((2, 2, 2), ELASTIC, (WALL,))
    nodes = method.nodes
    disturbed(nodes)
    nodes.partner[:] = -1
    stopped = nodes.position[:, 2] == 0.0
    before = upright_energy(nodes, stopped)
    done = set_off(method)
    assert_allclose(done[NORMAL_WORK], upright_energy(nodes, stopped) - before, rtol=1e-12)


def test_a_foot_that_touches_unevenly_hands_all_its_momentum_up() -> None:
    """To the node above, at their common speed: no impulse is in it, and what is lost is that of a plastic impact."""
    method = lagrangian.brick((2, 2, 2), ELASTIC, (WALL,))
    nodes = method.nodes
    disturbed(nodes)
    nodes.force[:] = 0.0
    foot = nodes.partner >= 0
    up = nodes.partner[foot]
    m, both = nodes.mass[foot], nodes.mass[foot] + nodes.mass[up]
    apart = nodes.velocity[foot, 2] - nodes.velocity[up, 2]
    common = nodes.velocity[up, 2] + m / both * apart
    done = set_off(method)
    assert np.abs(apart).min() > 0.01
    assert_allclose(nodes.velocity[up, 2], common, rtol=1e-13)
    assert_allclose(done[2], 0.0, atol=ROUNDING)
    assert_allclose(done[NORMAL_WORK], -(0.5 * m * (both - m) / both * apart**2).sum(), rtol=1e-12)


def test_a_node_that_carries_the_foot_s_mass_is_stopped_with_all_of_it() -> None:
    """Momentum along the normal is that of the mass that moves so, and so is what the wall takes."""
    method = lagrangian.brick((2, 2, 2), ELASTIC, (WALL,), lagrangian.flying(0.0, 0.0, -30.0))
    method.advance(DT)  # the foot has touched
    nodes = method.nodes
    up = int(nodes.partner[nodes.partner >= 0][4])
    assert nodes.normal_mass[up] > 1.4 * nodes.mass[up]
    nodes.position[up, 2], nodes.force[:] = 1e-6, 0.0
    before = method.totals()
    energy, dt = 0.5 * nodes.normal_mass[up] * nodes.velocity[up, 2] ** 2, 1e-6
    done = method.reactions.copy()
    method.kick(dt)
    rows = method.constrain(empty_rows(0), 0, 0, dt)
    solve(rows, 0, int(rows.size[0]), method.reactions)
    correct_velocity(nodes, rows, 0)
    now, taken = method.totals(), (method.reactions - done)[0]
    assert_allclose(now.momentum - before.momentum, taken[:3], atol=ROUNDING * before.mass * 30.0)
    assert_allclose(taken[NORMAL_WORK], 0.5 * nodes.normal_mass[up] * nodes.velocity[up, 2] ** 2 - energy, rtol=1e-12)
    assert taken[2] > 0.9 * nodes.normal_mass[up] * 20.0


def test_rollers_and_a_wall_on_one_node_act_alike_in_any_order() -> None:
    sides = tuple(symmetry_plane(axis, place) for axis in (0, 1) for place in (0.0, 2.0))
    wall, found = rigid_wall(0.0, 0.3), []
    for planes in ((wall, *sides), (*sides, wall)):
        method = lagrangian.brick((2, 2, 2), ELASTIC, planes, lagrangian.flying(0.0, 0.0, -30.0))
        method.nodes.velocity[:] += [20.0, 0.0, 0.0]
        start = method.totals()
        steps(method, 20)
        now = method.totals()
        assert_allclose(now.momentum - start.momentum, now.impulse - start.impulse, atol=1e-12 * start.mass * 30.0)
        found.append((method.nodes.velocity / 30.0, now.energy / start.energy))
    for one, other in zip(*found, strict=True):
        assert_allclose(one, other, atol=1e-12)


@pytest.mark.parametrize("volume", ["local", "cell-mean"])
def test_a_rattling_foot_changes_momentum_by_the_wall_s_impulse_alone(volume: str) -> None:
    def rattling(position: Array) -> Array:
        return 20.0 * np.random.default_rng(6).normal(size=position.shape) - [0.0, 0.0, 50.0]

    method, count = lagrangian.brick((2, 2, 3), ELASTIC, (WALL,), rattling, lift=0.05, volume=volume), 200
    start = method.totals()
    steps(method, count)
    now = method.totals()
    assert now.impulse[2] > start.mass * 50.0
    assert_allclose(now.momentum - start.momentum, now.impulse, rtol=0, atol=count * ROUNDING * start.mass * 100.0)


def test_a_plane_that_holds_takes_what_a_wall_takes_as_long_as_it_is_pushed() -> None:
    """Of material points, whose grid nodes come to the plane with a velocity and a force in each step."""
    taken = []
    for end in (rigid_wall(0.0, 0.0), symmetry_plane(2, 0.0)):
        method = columns.column(20, columns.ELASTIC, (end,), lambda z: np.full_like(z, -1e-3))
        steps(method, 4)  # later the front's ringing would pull
        taken.append(method.totals().contact)
    assert taken[0] > 0.0
    assert_allclose(taken[1], taken[0], rtol=4 * ROUNDING)
