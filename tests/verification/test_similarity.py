"""Bodies of any size do alike: no length, time, force or energy is built into a method.

An elastic impact at a given speed has no scale of its own. Lengths and times by 2^-10, and with them areas, forces and
energies by 2^-20 and 2^-30, are exact in binary: what differs is the rounding of sums, if anything.
"""

from typing import Any

import bricks
import columns
import lagrangian
import numpy as np
import pytest
import rings
from columns import ELASTIC, one_thread  # noqa: F401
from numpy.testing import assert_allclose

from viscopoint.interactions.planes import rigid_wall
from viscopoint.methods.mpm.geometry import Box

pytestmark = pytest.mark.usefixtures("one_thread")
SMALL = 2.0**-10  # a micrometre for a millimetre: forces of micronewtons
WALL, SPEED, VISCOSITY = (rigid_wall(0.0, 0.2),), 40.0, (0.06, 1.5)


def elements(scale: float, name: str) -> Any:
    body = bricks.brick((2 * scale, 2 * scale, 3 * scale), (2, 2, 3))
    return bricks.fem(body, bricks.ELEMENTS[name], ELASTIC, WALL, (3.0, 0.0, -SPEED), viscosity=VISCOSITY)


def disc(scale: float, name: str) -> Any:
    body = rings.section(2 * scale, 3 * scale, 2, 3)
    return rings.fem(body, bricks.ELEMENTS[name], ELASTIC, WALL, (0.0, 0.0, -SPEED), viscosity=VISCOSITY)


def reference_points(scale: float, name: str) -> Any:
    motion = lagrangian.flying(3.0, 0.0, -SPEED)
    return lagrangian.brick((2, 2, 3), ELASTIC, WALL, motion, cell=scale, volume=name, viscosity=VISCOSITY)


def points(scale: float, name: str) -> Any:
    box = Box((-4 * scale, -4 * scale, 0.0), (6 * scale, 6 * scale, 8 * scale))
    body = columns.block(scale, 2, 2, 3)
    return columns.rod(
        ELASTIC, (3.0, 0.0, -SPEED), WALL, cell=scale, box=box, body=body, contact=name, viscosity=VISCOSITY
    )


KINDS = {
    **{f"fem-{name}": (elements, name) for name in bricks.ELEMENTS},
    **{f"rings-{name}": (disc, name) for name in bricks.ELEMENTS},
    **{f"tlmpm-{name}": (reference_points, name) for name in ("local", "cell-mean")},
    **{f"mpm-{name}": (points, name) for name in ("nodes", "gated")},
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_body_a_thousand_times_as_small_hits_and_rebounds_alike(kind: str) -> None:
    make, name = KINDS[kind]
    found = []
    for scale in (1.0, SMALL):
        method, time = make(scale, name), 0.0
        start = method.totals()
        while time < 0.012 * scale:  # three and a half passages of the wave: it has left the wall
            dt = min(method.stable_step(), 0.012 * scale - time)
            method.advance(dt)
            time += dt
        now = method.totals()
        energies = np.array([now.kinetic, now.stored, now.viscous, now.contact, now.friction]) / scale**3
        found.append(np.hstack([energies, now.momentum / scale**3, now.impulse / scale**3]))
        assert now.momentum[2] > 0.5 * start.mass * SPEED
    scale = np.abs(found[0]).max()
    assert_allclose(found[1], found[0], rtol=1e-9, atol=1e-12 * scale)
