"""What every step keeps with transfers other than the paper's, whatever else it is made of."""

from typing import Any

import conserved
import numpy as np
import pytest
from columns import Array, one_thread, rod  # noqa: F401
from conserved import ROUNDING, steps
from numpy.testing import assert_allclose

import viscopoint as vp
from viscopoint.interactions.planes import rigid_wall
from viscopoint.methods.mpm.fills.rings import rod_rings
from viscopoint.methods.mpm.geometry import Box
from viscopoint.methods.mpm.method import MaterialPointMethod
from viscopoint.methods.mpm.transfers.affine_pic import Apic, Tpic
from viscopoint.model.build import build

pytestmark = pytest.mark.usefixtures("one_thread")
NEW = [(Apic(), "gimp"), (Tpic(), "gimp"), (Apic(), "trilinear")]
TRANSFER = pytest.mark.parametrize(("transfer", "shape"), NEW, ids=str)
SCHEMES = [
    (*pair, scheme) for pair in NEW for scheme in ("musl", "usf", "usl") if (pair[1], scheme) != ("trilinear", "usl")
]
SCHEME = pytest.mark.parametrize(("transfer", "shape", "scheme"), SCHEMES, ids=str)  # others are refused


def impact(**choices: Any) -> MaterialPointMethod:
    body = rod_rings(2.0, 6.0, 0.5)
    return rod(velocity=(20.0, 5.0, -100.0), walls=(rigid_wall(0.0, 0.3),), cell=1.0, body=body, **choices)


@SCHEME
@pytest.mark.parametrize("volume", ["local", "cell-mean"])
def test_wall_impulse_is_the_change_of_momentum(transfer: Any, shape: str, scheme: str, volume: str) -> None:
    method = impact(transfer=transfer, shape=shape, scheme=scheme, volume=volume)
    start, count = method.totals(), 60
    now = steps(method, count).totals()
    assert now.impulse[2] > 0.1 * start.mass * 100.0
    assert now.impulse[0] < 0.0
    assert np.hypot(*now.impulse[:2]) <= 0.3 * now.impulse[2] * (1 + ROUNDING)
    atol = count * ROUNDING * start.mass * np.abs(method.points.velocity).max()
    assert_allclose(now.momentum - start.momentum, now.impulse, rtol=0, atol=atol)


@SCHEME
def test_free_flight_changes_nothing(transfer: Any, shape: str, scheme: str) -> None:
    velocity, time, count = np.array([13.0, -17.0, 11.0]), 0.1, 270  # 1.4 cells, at 1/3 Courant number
    method = rod(velocity=velocity, lift=1.0, transfer=transfer, shape=shape, scheme=scheme)
    start = method.points.position.copy()
    for _ in range(count):
        method.advance(time / count)
    points, strain = method.points, 10 * count * ROUNDING  # corrections and gradients multiply roundings
    assert_allclose(points.velocity, np.broadcast_to(velocity, start.shape), rtol=strain)
    assert_allclose(points.position, start + time * velocity, rtol=0, atol=strain * 6.0)
    assert_allclose(points.shared.jacobian, 1.0, rtol=strain)


@TRANSFER
def test_thread_count_changes_no_bit(transfer: Any, shape: str) -> None:
    conserved.assert_thread_count_changes_no_bit(lambda: steps(impact(transfer=transfer, shape=shape), 30).state())


@TRANSFER
def test_restored_run_goes_on_bit_for_bit(transfer: Any, shape: str) -> None:
    conserved.assert_restored_run_goes_on_bit_for_bit(lambda: impact(transfer=transfer, shape=shape), 15)


@TRANSFER
def test_losing_points_keeps_momentum(transfer: Any, shape: str) -> None:
    def motion(position: Array) -> Array:
        return np.array([9.0, 7.0, 11.0]) * (position - [0.0, 0.0, 3.0]) + [3.0, -2.0, 34.0]

    box = Box((-6.0, -6.0, 0.0), (6.0, 6.0, 12.2))
    velocity = motion(rod().body.position)
    method = rod(velocity=velocity, lift=6.0, box=box, transfer=transfer, shape=shape)
    start = method.totals()
    steps(method, 60)
    assert 0 < method.lost() < len(velocity) // 2
    atol = 60 * ROUNDING * start.mass * np.abs(velocity).max()
    assert_allclose(method.totals().momentum, start.momentum, rtol=0, atol=atol)


def test_a_guard_names_the_transfer_that_dissipates() -> None:
    for name, words in (("flip", "method.pic_fraction"), ("apic", "method.transfer")):
        method = build(vp.Case.load("paper", {"method.transfer": name})).method
        assert words in method.failure_hints.dissipating
