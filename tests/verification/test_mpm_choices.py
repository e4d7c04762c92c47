"""What every step keeps, whatever shape functions, fill, volume and scheme it is made of."""

from itertools import product

import conserved
import numpy as np
import pytest
from columns import ELASTIC, one_thread, rod  # noqa: F401
from conserved import ROUNDING, missing_after, steps
from numpy.testing import assert_allclose

from viscopoint.interactions.planes import rigid_wall
from viscopoint.methods.mpm.fills import FILLS
from viscopoint.methods.mpm.method import MaterialPointMethod
from viscopoint.methods.mpm.schemes import SCHEMES
from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.methods.mpm.volumes import VOLUMES

pytestmark = pytest.mark.usefixtures("one_thread")
NEW = [
    *((shape, "local") for shape in sorted(SHAPES) if shape != "trilinear"),
    *product(("trilinear", "gimp"), sorted(set(VOLUMES) - {"local"})),
]
PARTS = pytest.mark.parametrize(("shape", "volume"), NEW)
FILL = pytest.mark.parametrize("fill", sorted(FILLS.keys() - {"lattice"}))  # most other tests are on the lattice
SCHEME = pytest.mark.parametrize(
    ("shape", "volume", "scheme"),
    [
        # schemes differ in what they do with shape functions, not by shape: all of them with GIMP, others as studies
        pytest.param(
            shape, volume, scheme, marks=[] if scheme == "musl" or shape in {"trilinear", "gimp"} else pytest.mark.long
        )
        for shape, volume in NEW
        for scheme in sorted(SCHEMES)
    ],
)
STEPS = {"musl": 60, "usf": 60, "usl": 10}  # the plain "usl" does not survive nodes of hardly any mass


def impact(fill: str, shape: str, volume: str, scheme: str = "musl") -> MaterialPointMethod:
    body, walls = FILLS[fill](2.0, 6.0, 0.5), (rigid_wall(0.0, 0.3),)
    velocity = (20.0, 5.0, -100.0)
    return rod(velocity=velocity, walls=walls, cell=1.0, body=body, shape=shape, volume=volume, scheme=scheme)


@FILL
@SCHEME
def test_wall_impulse_is_the_change_of_momentum(fill: str, shape: str, volume: str, scheme: str) -> None:
    method = impact(fill, shape, volume, scheme)
    start, count = method.totals(), STEPS[scheme]
    now = steps(method, count).totals()
    assert now.impulse[2] > 0.1 * start.mass * 100.0
    speed = np.abs(method.points.velocity).max()
    atol = count * ROUNDING * start.mass * speed
    assert_allclose(now.momentum - start.momentum, now.impulse, rtol=0, atol=atol)


@FILL
@SCHEME
def test_free_flight_changes_nothing(fill: str, shape: str, volume: str, scheme: str) -> None:
    velocity, time, count = np.array([13.0, -17.0, 11.0]), 0.1, 270  # 1.4 cells, at 1/3 Courant number
    body = FILLS[fill](2.0, 6.0, 0.5)
    method = rod(velocity=velocity, lift=1.0, body=body, shape=shape, volume=volume, scheme=scheme)
    start = method.points.position.copy()
    for _ in range(count):
        method.advance(time / count)
    points, strain = method.points, count * ROUNDING
    assert_allclose(points.velocity, np.broadcast_to(velocity, start.shape), rtol=strain)
    assert_allclose(points.position, start + time * velocity, rtol=0, atol=strain * 6.0)
    assert_allclose(points.shared.jacobian, 1.0, rtol=strain)
    assert_allclose(points.material.stress, 0.0, atol=method.material.p_wave_modulus * strain)


@FILL
@PARTS
def test_energy_of_a_small_vibration_closes_to_first_order_in_the_time_step(fill: str, shape: str, volume: str) -> None:
    errors = []
    for safety in (0.2, 0.1, 0.05):
        body = FILLS[fill](2.0, 6.0, 0.5)
        motion = 0.2 * (body.position - [0.0, 0.0, 3.0]) * [1.0, -0.6, -1.5]
        damping = (0.0, 0.0)
        method = rod(ELASTIC, motion, lift=6.0, safety=safety, viscosity=damping, body=body, shape=shape, volume=volume)
        errors.append(missing_after(method))
    assert_allclose([errors[0] / errors[1], errors[1] / errors[2]], 2.0, rtol=0.15)
    assert abs(2 * errors[2] - errors[1]) < 0.1 * errors[2]  # nothing else is missing


@PARTS
def test_thread_count_changes_no_bit(shape: str, volume: str) -> None:
    conserved.assert_thread_count_changes_no_bit(lambda: steps(impact("rings", shape, volume), 30).state())


@PARTS
def test_restored_run_goes_on_bit_for_bit(shape: str, volume: str) -> None:
    conserved.assert_restored_run_goes_on_bit_for_bit(lambda: impact("rings", shape, volume), 15)
