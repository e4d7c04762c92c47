"""What linear fields must do on the undeformed grid of a round body: strain all points alike, pull nowhere inside."""

import numpy as np
import pytest
from columns import one_thread  # noqa: F401
from conserved import EPS
from lagrangian import ELASTIC, Array, brick, each_volume, lagrangian, levels, moved, rod, survives
from material_point import orders
from numpy.testing import assert_allclose

from viscopoint.kernels.tensors import COMPONENTS
from viscopoint.methods.mpm.fills import FILLS
from viscopoint.methods.mpm.fills.trimmed import rod_trimmed
from viscopoint.methods.tlmpm.method import TotalLagrangianMethod

pytestmark = pytest.mark.usefixtures("one_thread")
each_fill = pytest.mark.parametrize("fill", sorted(FILLS))
each_shape = pytest.mark.parametrize("shape", ["trilinear", "gimp"])
STRETCH = np.array([[0.11, 0.23, -0.07], [-0.13, 0.05, 0.17], [0.08, -0.19, -0.21]])  # of a step, not small
SMALL = 1e3 * EPS


def turn(angle: float) -> Array:
    """Return the rotation by an angle about (1, 2, 2) / 3."""
    x, y, z = np.array([1.0, 2.0, 2.0]) / 3.0
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def full(stress: Array) -> Array:
    """Return stresses as matrices."""
    place = {name: k for k, name in enumerate(COMPONENTS)}
    named = [["xx", "xy", "zx"], ["xy", "yy", "yz"], ["zx", "yz", "zz"]]
    return stress[..., [[place[name] for name in row] for row in named]]


@each_fill
@each_shape
def test_uniform_strain_is_uniform_up_to_the_cut_surface(fill: str, shape: str) -> None:
    method = rod(ELASTIC, fill=fill, shape=shape, viscosity=(0.0, 0.0))
    moved(method, method.reference @ STRETCH.T, 1.0)
    points = method.points
    now = np.eye(3) + STRETCH
    assert_allclose(points.deformation, np.broadcast_to(now.ravel(), points.deformation.shape), rtol=0, atol=SMALL)
    assert_allclose(points.position, points.reference @ now.T, rtol=0, atol=6.0 * SMALL)
    assert_allclose(points.shared.jacobian, np.linalg.det(now), rtol=SMALL)
    stress = points.material.stress[0]
    assert np.abs(stress).max() > 10.0  # MPa
    assert_allclose(
        points.material.stress, np.broadcast_to(stress, points.material.stress.shape), rtol=0, atol=1e3 * SMALL
    )


def test_mass_and_its_first_moments_are_the_points() -> None:
    method = rod()
    density, volume = method.material.density, method.points.volume
    assert_allclose(method.nodes.mass.sum(), density * np.pi * 4.0 * 6.0, rtol=1e-12)  # a cylinder's
    assert method.nodes.mass.min() > 0.0
    moment = density * volume @ method.points.reference
    assert_allclose(method.nodes.mass @ method.reference, moment, rtol=0, atol=SMALL * 6.0)


@each_volume
@each_shape
def test_uniform_stress_pulls_at_no_node_inside(volume: str, shape: str) -> None:
    method = rod(ELASTIC, volume=volume, shape=shape, viscosity=(0.0, 0.0))
    force = moved(method, method.reference @ STRETCH.T, 1.0)
    inside = (np.hypot(*np.abs(method.reference.T[:2]) + 1.0) < 2.0) & (np.abs(method.reference[:, 2] - 3.0) < 2.75)
    assert inside.sum() > 5
    scale = np.abs(force).max()
    assert scale > 1.0  # N, on the surface
    assert_allclose(force[inside], 0.0, atol=scale * SMALL)


@each_volume
def test_forces_have_no_resultant_and_no_moment(volume: str) -> None:
    method = rod(ELASTIC, volume=volume)
    velocity = method.reference @ STRETCH.T + np.random.default_rng(3).normal(size=method.reference.shape) / 20
    force = moved(method, velocity, 1.0)
    scale = np.abs(force).max()
    assert_allclose(force.sum(axis=0), 0.0, atol=scale * SMALL)
    assert_allclose(np.cross(method.nodes.position, force).sum(axis=0), 0.0, atol=10.0 * scale * SMALL)


@each_volume
def test_forces_do_the_work_that_the_points_take(volume: str) -> None:
    """Power of the nodes' forces and of P : dF, to second order in the step, whoever shares dilatation with whom."""
    errors = []
    for dt in (0.4, 0.2, 0.1):
        method = rod(ELASTIC, volume=volume, viscosity=(0.0, 0.0))
        noise = np.random.default_rng(3).normal(size=method.reference.shape) / 50
        before = moved(method, method.reference @ STRETCH.T / 3 + noise, 1.0)
        taken = method.totals()
        more = np.random.default_rng(5).normal(size=noise.shape) / 50
        after = moved(method, more, dt)
        now = method.totals()
        work = -dt * float((0.5 * (before + after) * more).sum())
        known, earlier = (each.stored + each.dissipated + each.hypoelastic for each in (now, taken))
        errors.append((known - earlier - work) / dt)
    assert_allclose(orders([abs(error) for error in errors]), 2, atol=0.1)


def test_a_prestressed_body_turns_rigidly_many_times() -> None:
    method = rod(ELASTIC, viscosity=(0.0, 0.0))
    moved(method, method.reference @ STRETCH.T / 5, 1.0)
    start, place = full(method.points.material.stress.copy()), method.nodes.position.copy()
    history = full(method.points.material.history.copy())
    count, turns = 70, 10
    for k in range(1, count + 1):
        target = place @ turn(2 * np.pi * turns * (k - 0.3) / count).T
        moved(method, target - method.nodes.position, 1.0)
    last = turn(2 * np.pi * turns * (count - 0.3) / count)
    scale = count * SMALL * np.abs(start).max()
    assert_allclose(full(method.points.material.stress), last @ start @ last.T, rtol=0, atol=scale)
    assert_allclose(full(method.points.material.history), last @ history @ last.T, rtol=0, atol=scale)


def test_reach_bounds_the_step_sharply() -> None:
    def block() -> TotalLagrangianMethod:
        rng = np.random.default_rng(2)
        return brick((3, 3, 3), motion=lambda x: 1e-6 * rng.normal(size=x.shape), volume="local")

    assert survives(block(), 0.99)
    assert not survives(block(), 1.3)  # reach holds for any K and G of this modulus


@pytest.mark.parametrize("squeeze", [0.5, 2.0])
def test_step_follows_the_smallest_stretch(squeeze: float) -> None:
    method = brick((2, 2, 2))
    moved(method, method.reference * [0.0, 0.0, squeeze - 1.0], 1.0)
    smallest, J = min(squeeze, 1.0), squeeze
    assert_allclose(method.critical.min(), method.stable_length * smallest / (method.sound * np.sqrt(J)), rtol=SMALL)


def test_levels_are_planes_of_nodes() -> None:
    method: TotalLagrangianMethod = lagrangian(rod_trimmed(2.0, 6.0, 0.5), (1.0, 1.0, 0.5))
    assert_allclose(levels(method, method.reference[:, 2]), np.arange(13) * 0.5, atol=SMALL)
