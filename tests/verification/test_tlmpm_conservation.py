"""What a step of total Lagrangian points must keep: momentum, energy, freedom after contact, every bit.

See ``conserved``.
"""

from typing import Any

import conserved
import numpy as np
import pytest
from columns import advance, one_thread, order  # noqa: F401
from conserved import RELAXING, ROUNDING, missing, missing_after, spin, steps, stirred, trembling
from lagrangian import ELASTIC, brick, column, each_volume, flying, levels, rod, upward
from numpy.testing import assert_allclose, assert_array_equal

from viscopoint.interactions.planes import rigid_wall, symmetry_plane
from viscopoint.kernels.arrays import Real
from viscopoint.methods.mpm.fills import FILLS
from viscopoint.methods.tlmpm.method import TotalLagrangianMethod

pytestmark = pytest.mark.usefixtures("one_thread")
each_fill = pytest.mark.parametrize("fill", sorted(FILLS))


def impact(friction: float = 0.1, **choices: Any) -> TotalLagrangianMethod:
    return rod(RELAXING, flying(20.0, 5.0, -100.0), (rigid_wall(0.0, friction),), **choices)


# --- flight ---


@each_fill
@each_volume
def test_free_flight_over_many_cells_strains_nothing(fill: str, volume: str) -> None:
    velocity, count = np.array([53.0, -77.0, 41.0]), 400
    method = rod(RELAXING, flying(*velocity), fill=fill, volume=volume)
    time = count * method.stable_step()
    assert time * np.abs(velocity).min() > 2.0  # mm, two cells
    for _ in range(count):
        method.advance(time / count)
    points, strain = method.points, count * ROUNDING
    assert_allclose(points.position, points.reference + time * velocity, rtol=0, atol=strain * 9.0)
    assert_allclose(method.velocities(), np.broadcast_to(velocity, points.position.shape), rtol=strain)
    assert_allclose(points.shared.jacobian, 1.0, rtol=strain)
    assert_allclose(points.material.stress, 0.0, atol=method.material.p_wave_modulus * strain)


@each_volume
def test_linear_and_angular_momentum_are_kept_without_a_wall(volume: str) -> None:
    conserved.assert_free_flight_keeps_both_momenta(rod(RELAXING, stirred, volume=volume))


def test_a_spinning_body_keeps_turning_rigidly_and_crosses_cells_unseen() -> None:
    """Strain is only the centrifugal one, rho (w r)^2 / M, and what it rings with."""
    rate, time = 3.0, 2.0  # rad/ms: a whole turn; 6 mm/ms at the circumference
    method = rod(ELASTIC, lambda x: np.column_stack([-rate * x[:, 1], rate * x[:, 0], 0.0 * x[:, 0]]))
    start, turning = method.totals(), spin(method)
    advance(method, time)
    strain = 1e-3 * (rate * 2.0) ** 2 / 140.0
    radius = [np.hypot(*place.T[:2]) for place in (method.points.position, method.points.reference)]
    assert_allclose(radius[0], radius[1], rtol=0, atol=2.0 * strain * 2.0)
    assert_allclose(method.totals().kinetic, start.kinetic, rtol=4.0 * strain)
    assert_allclose(spin(method), turning, rtol=0, atol=1e-10 * turning[2])


# --- contact ---


@each_volume
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_wall_impulse_is_the_change_of_momentum(volume: str, friction: float) -> None:
    conserved.assert_wall_impulse_is_the_change_of_momentum(impact(friction, volume=volume), friction)


def test_contact_is_made_exactly_when_the_foot_has_crossed_the_gap() -> None:
    gap, speed, height = 0.0823, 40.0, -0.7
    method = brick((2, 2, 3), ELASTIC, (rigid_wall(height, 0.2),), flying(0.0, 0.0, -speed), lift=height + gap)
    foot = method.nodes.partner >= 0
    assert foot.sum() == 9
    conserved.assert_contact_is_made_when_the_gap_is_crossed(method, foot, height, gap, speed)


def test_first_touch_takes_no_energy() -> None:
    cells, speed = 50, 1.0
    method = column(cells, RELAXING, motion=upward(lambda z: np.full_like(z, -speed)))
    start = method.totals()
    advance(method, 0.02)
    assert method.totals().impulse[2] > 0.1 * start.mass * speed
    # all nodes fly alike: none loses speed to the one above; half a layer that stops would take 1/2 of 1/cells
    assert abs(method.totals().contact) < 1e-6 * start.kinetic / cells
    assert abs(missing(start, method.totals())) < 0.05 / cells
    assert method.totals().friction == 0.0


def test_nodes_beside_the_foot_stop_as_they_are() -> None:
    """Sides that roll onto the wall have no node above: they arrive on it, and lose their speed and its energy."""
    gap, speed, slide = 0.03, 40.0, 30.0
    method = brick((2, 2, 3), ELASTIC, (rigid_wall(0.0, 0.2),), flying(slide, 0.0, -speed), lift=gap)
    foot, start, dt = method.nodes.partner >= 0, method.totals(), method.stable_step()
    method.nodes.partner[:] = -1
    while method.totals().impulse[2] == 0.0:
        method.advance(dt)
    mass, now = method.nodes.mass[foot].sum(), method.totals()
    assert_array_equal(method.nodes.position[foot, 2], 0.0)
    assert_array_equal(method.nodes.velocity[foot, 2], 0.0)
    # what stops the foot, and half a step of the force of cells that are strained by less than v dt / h
    assert mass * speed <= now.impulse[2] < mass * speed + 0.5 * dt * 4.0 * method.material.p_wave_modulus * speed * dt
    assert_allclose(now.impulse[0], -0.2 * now.impulse[2], rtol=1e-3)  # what swells slides a little sideways too
    assert_allclose(now.contact, 0.5 * mass * speed**2, rtol=1e-10)
    for _ in range(200):
        method.advance(dt)
        assert method.nodes.position[:, 2].min() >= 0.0
    now = method.totals()
    assert_allclose(now.momentum - start.momentum, now.impulse, rtol=0, atol=300 * ROUNDING * start.mass * speed)
    assert abs(missing(start, now)) < 0.01


def test_sliding_block_feels_coulomb_friction() -> None:
    friction, speed = 0.2, 20.0
    walls = (rigid_wall(0.0, friction), symmetry_plane(1, 0.0), symmetry_plane(1, 2.0))
    method = brick((4, 2, 3), ELASTIC, walls, flying(speed, 0.0, -1.0))
    conserved.assert_slides_by_coulomb(method, friction, speed)


def test_slow_block_sticks_and_no_more() -> None:
    """The wall's push grows from nothing: it stops the foot as soon as it has taken its momentum, and then holds it."""
    slide, speed = 0.1, 10.0
    law = ELASTIC._replace(bulk=2 / 3 * (ELASTIC.shear_maxwell + ELASTIC.shear_long))  # does not swell sideways
    method = brick((3, 3, 3), law, (rigid_wall(0.0, 0.5),), flying(slide, 0.0, -speed))
    steps(method, 8)
    foot = method.nodes.partner >= 0
    assert_array_equal(method.nodes.velocity[foot, :2], 0.0)
    push = method.totals().impulse
    assert -push[0] < 0.5 * push[2]
    assert 0.0 < method.totals().friction < 0.5 * method.totals().mass * slide**2


# --- energy ---


def shaken(law: Any, safety: float, volume: str, viscosity: tuple[float, float] = (0.0, 0.0)) -> float:
    """Return what is missing of a rod's energy after some vibration."""
    return missing_after(rod(law, trembling, safety=safety, viscosity=viscosity, volume=volume))


@each_volume
@pytest.mark.parametrize("law", [ELASTIC, RELAXING], ids=["elastic", "viscoelastic"])
@pytest.mark.parametrize("viscosity", [(0.0, 0.0), (0.6, 1.5)], ids=["plain", "bulk-viscous"])
def test_energy_of_a_small_vibration_closes_to_second_order_in_the_time_step(
    law: Any, viscosity: tuple[float, float], volume: str
) -> None:
    errors = [shaken(law, safety, volume, viscosity) for safety in (0.8, 0.4, 0.2)]
    # waves of the grid's length swing in their own phase: what they add is up to a quarter of an order
    assert_allclose(order(np.abs(errors).tolist()), 2.0, atol=0.25)


# --- bits ---


@each_volume
@pytest.mark.parametrize(
    ("shape", "real"), [("trilinear", np.float64), ("gimp", np.float64), ("trilinear", np.float32)]
)
def test_thread_count_changes_no_bit(volume: str, shape: str, real: Real) -> None:
    def state() -> dict[str, Any]:
        method = steps(impact(spacing=0.25, volume=volume, shape=shape, fill="rings", real=real), 40)
        return {**method.state(), "totals": np.hstack(method.totals()), "seen": method.velocities()}

    conserved.assert_thread_count_changes_no_bit(state)


@each_volume
def test_restored_run_goes_on_bit_for_bit(volume: str) -> None:
    conserved.assert_restored_run_goes_on_bit_for_bit(lambda: impact(volume=volume))


def test_planes_of_the_rod_s_nodes_begin_with_its_foot() -> None:
    method = rod(walls=(rigid_wall(0.0, 0.0),))
    heights = levels(method, method.reference[:, 2])
    assert_allclose(heights, np.arange(13) * 0.5, rtol=0, atol=1e-12)
    assert ((method.nodes.partner >= 0) == (method.reference[:, 2] < 0.25)).all()
    up = method.nodes.partner[method.nodes.partner >= 0]
    assert_allclose(method.reference[up, 2], 0.5, atol=1e-12)
