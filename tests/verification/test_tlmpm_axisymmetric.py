"""Total Lagrangian rings: uniform strain, breathing, plane waves, and what every step keeps."""

import conserved
import numpy as np
import pytest
from columns import one_thread, order  # noqa: F401
from conserved import EPS, RELAXING, ROUNDING, missing_after, steps
from cylinders import (
    DENSITY,
    ELASTIC,
    RADIUS,
    ROOT,
    SOUND,
    Array,
    breathing,
    frequency,
    j1,
    lagrangian_rings,
    stretching,
)
from lagrangian import ON_WALL, column, each_volume, levels, moved, survives
from numpy.testing import assert_allclose, assert_array_equal

from viscopoint.interactions.planes import rigid_wall, symmetry_plane
from viscopoint.methods.tlmpm.filling import rod_meridian
from viscopoint.methods.tlmpm.method import TotalLagrangianMethod

pytestmark = pytest.mark.usefixtures("one_thread")
SMALL = 1e3 * EPS


@each_volume
def test_uniform_strain_is_uniform_and_pulls_at_no_node_inside(volume: str) -> None:
    across, upward = 0.11, -0.07  # of a step, not small
    method = lagrangian_rings(5, 12, volume=volume)
    force, (r, _, z) = moved(method, stretching(across, upward)(method.reference), 1.0), method.reference.T
    points = method.points
    now = np.diag([1 + across, 1 + across, 1 + upward])
    assert_allclose(points.deformation, np.tile(now.ravel(), (len(points.volume), 1)), rtol=0, atol=SMALL)
    assert_allclose(
        points.material.stress, np.tile(points.material.stress[0], (len(points.volume), 1)), rtol=0, atol=1e3 * SMALL
    )
    assert np.abs(points.material.stress[0, :3]).min() > 10.0  # MPa
    inside = (r < 0.9 * RADIUS) & (z > 0.1) & (z < z.max() - 0.3)
    assert inside.sum() > 20
    force[r < SMALL, 0] = 0.0  # on the axis nothing moves across, whatever pulls
    scale = np.abs(force).max()
    assert_allclose(force[inside], 0.0, atol=scale * SMALL)
    assert_array_equal(force[:, 1], 0.0)
    assert_allclose(force.sum(axis=0)[2], 0.0, atol=scale * SMALL)


def test_volume_mass_and_surface_are_the_cylinder_s() -> None:
    for radius, spacing, per_cell in ((3.8, 0.38, 2), (3.2, 0.7, 3), (2.0, 1.5, 2)):
        body = rod_meridian(radius, 10.0, spacing, per_cell)
        assert_allclose(body.volume.sum(), np.pi * radius**2 * 10.0, rtol=1e-14)
        assert_allclose(body.volume @ body.position[:, 2] / body.volume.sum(), 5.0, rtol=1e-14)
        assert_array_equal(body.position[:, 1], 0.0)
        assert_allclose(body.position[body.surface.ring, 0], radius, rtol=1e-14)
    method = lagrangian_rings(4, 8)
    assert_allclose(method.nodes.mass.sum(), DENSITY * np.pi * RADIUS**2 * 2.0, rtol=1e-14)


@each_volume
def test_cylinder_breathes_at_its_frequency_to_second_order(volume: str) -> None:
    errors = []
    for cells in (8, 16):
        cell = RADIUS / cells
        held = (symmetry_plane(2, 0.0), symmetry_plane(2, cell))
        method = lagrangian_rings(cells, 2, boundaries=held, motion=breathing, volume=volume)
        weight = method.nodes.mass * j1(ROOT * method.reference[:, 0] / RADIUS)
        dt, signal = 0.25 * cell / SOUND, list[float]()
        for _ in range(40 * cells):  # some four periods
            signal.append(float(weight @ method.nodes.velocity[:, 0]))
            method.advance(dt)
        errors.append(frequency(np.array(signal), dt) * RADIUS / (ROOT * SOUND) - 1)
        assert abs(errors[-1]) < (ROOT / cells) ** 2 / 24  # no more than a row of masses and springs
    assert_allclose(order(errors), 2.0, atol=0.05)  # the next term is (ROOT / cells)² < 0.08 of it


def test_plane_wave_in_a_confined_column_is_that_of_the_three_dimensional_code() -> None:
    """Nothing moves across, so that every ring is a chain of masses and springs along z like any column's."""
    cells, speed, count = 50, 1e-4, 100
    solid = column(cells, RELAXING, motion=lambda x: np.tile([0.0, 0.0, -speed], (len(x), 1)), volume="local")
    cell, dt = 25.4 / cells, solid.stable_step()
    rollers = (*ON_WALL, symmetry_plane(0, RADIUS))
    method = lagrangian_rings(
        2, 2 * cells, RELAXING, rollers, lambda x: np.tile([0.0, 0.0, -speed], (len(x), 1)),
        height=cell / 2, cell_height=cell, volume="local",
    )  # fmt: skip
    for _ in range(count):
        solid.advance(dt)
        method.advance(dt)
    seen = [levels(run, run.nodes.velocity[:, 2]) for run in (method, solid)]
    assert_allclose(seen[0], seen[1], rtol=0, atol=speed * count * ROUNDING)
    pushes = [run.totals().impulse[2] for run in (method, solid)]
    assert_allclose(pushes[0] / (np.pi * RADIUS**2), pushes[1] / cell**2, rtol=count * ROUNDING)


def impact(friction: float = 0.3) -> TotalLagrangianMethod:
    return lagrangian_rings(
        4, 24, RELAXING, (rigid_wall(0.0, friction),), lambda x: np.tile([0.0, 0.0, -100.0], (len(x), 1)),
        viscosity=(0.06, 1.5),
    )  # fmt: skip


def test_wall_impulse_is_the_change_of_momentum_and_nothing_moves_around() -> None:
    method, count = impact(), 300
    start = method.totals()
    now = steps(method, count).totals()
    assert now.impulse[2] > 0.1 * start.mass * 100.0
    assert now.friction > 0.0
    scale = count * ROUNDING * start.mass * 100.0
    assert_allclose(now.momentum - start.momentum, now.impulse, rtol=0, atol=scale)
    assert_array_equal([now.momentum[:2], now.impulse[:2]], 0.0)
    assert_array_equal(method.nodes.velocity[method.reference[:, 0] == 0.0, 0], 0.0)
    assert_array_equal(method.nodes.velocity[:, 1], 0.0)
    assert abs(conserved.missing(start, now)) < 0.005  # what is asked of the energy balance


def test_energy_of_a_small_vibration_closes_to_second_order_in_the_time_step() -> None:
    def motion(position: Array) -> Array:
        r, _, z = position.T / 4.0
        return 1e-3 * np.column_stack([np.sin(2 * r) * np.cos(3 * z), 0.0 * r, np.cos(2 * r) - z])

    bodies = [lagrangian_rings(4, 24, ELASTIC, motion=motion, safety=safety) for safety in (0.8, 0.4, 0.2)]
    errors = [abs(missing_after(body)) for body in bodies]
    assert_allclose(order(errors), 2.0, atol=0.25)  # as in three dimensions


def test_reach_bounds_the_step_sharply() -> None:
    def trembling() -> TotalLagrangianMethod:
        rng = np.random.default_rng(2)
        return lagrangian_rings(4, 8, motion=lambda x: 1e-6 * rng.normal(size=x.shape) * [1.0, 0.0, 1.0])

    assert survives(trembling(), 0.99)
    assert not survives(trembling(), 1.3)  # reach holds for any K and G of this modulus


def test_restored_run_goes_on_bit_for_bit() -> None:
    conserved.assert_restored_run_goes_on_bit_for_bit(impact)
