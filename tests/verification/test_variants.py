"""Wave fronts in a viscoelastic column by the variants of the material point method; ``test_column`` has the paper's.

With FLIP, weights of variance s cells² filter a wave four times between force and strain: w = c k (1 - D (kh)²) with
D = s - C²/24 for B-splines (``test_mpm_splines``). Boxes of points half a cell apart, at quarters of a cell, have the
trilinear weights there, and so the trilinear D. Transfers that make up for the two maps between points and nodes leave
1/24 - C²/24 of that.
"""

import laplace
import numpy as np
import pytest
from columns import (  # noqa: F401
    COURANT,
    DENSITY,
    DISPERSION,
    LENGTH,
    MODULI,
    advance,
    area,
    column,
    layers,
    one_thread,
    viscoelastic,
)
from fronts import HALF, errors, width
from numpy.testing import assert_allclose
from test_column import SPEED

from viscopoint.methods.mpm.transfers import Transfer
from viscopoint.methods.mpm.transfers.affine_pic import Apic
from viscopoint.methods.mpm.transfers.flip import Flip

pytestmark = pytest.mark.usefixtures("one_thread")
LEAPFROG = COURANT**2 / 24
FLIP = [
    ("gimp", Flip(0.0), DISPERSION),
    ("cpgimp", Flip(0.0), DISPERSION),
    ("quadratic", Flip(0.0), 3 / 12 - LEAPFROG),
    ("cubic", Flip(0.0), 4 / 12 - LEAPFROG),
]
OTHERS = [("trilinear", Apic(), 1 / 24 - LEAPFROG)]
CELLS, DECAY, TIME = 100, 65.0, 0.02


@pytest.mark.parametrize(("shape", "transfer", "dispersion"), [*FLIP, *OTHERS], ids=str)
def test_front_errs_by_no_more_than_dispersion_and_a_cell(shape: str, transfer: Transfer, dispersion: float) -> None:
    solid, h = laplace.confined(*MODULI, DECAY), LENGTH / CELLS
    law, start = viscoelastic(DECAY), -SPEED
    method = column(CELLS, law, velocity=lambda z: np.full_like(z, start), shape=shape, transfer=transfer)
    x = layers(method.body.position[:, 2])
    advance(method, TIME)
    now = layers(method.points.velocity[:, 2])
    missed = float(np.abs(now / SPEED - laplace.velocity(solid, LENGTH, 1.0, x, TIME)).mean())
    assert missed < 1.1 * errors(solid, LENGTH, dispersion * h**2, TIME, x)[0]
    pushed = float(method.totals().impulse[2]) / area(method) - laplace.wall_impulse(solid, LENGTH, SPEED, TIME)
    assert abs(pushed) < DENSITY * SPEED * h  # contact is known to a cell
    half, place, w = solid.front(solid.speed * TIME) / 2, solid.speed * TIME, width(solid, dispersion * h**2, TIME)
    gain = now / SPEED + 1
    i = np.flatnonzero(gain > half)[-1]
    front = x[i] + (gain[i] - half) / (gain[i] - gain[i + 1]) * (x[i + 1] - x[i])
    # as in ``test_column``; transfers that forget what nodes do not see also round the front off, within a cell
    assert_allclose(front - place, HALF * w, rtol=0, atol=0.05 * w if isinstance(transfer, Flip) else h / 2)
