"""The manufactured vibration of ``test_tlmpm_manufactured`` by points on a background grid that they move through.

The body force is given to the points at the beginning of each step, as the force of the stress is: with velocities
known half a step before and after positions, steps are of second order.
"""

import numpy as np
import pytest
from columns import COURANT, ELASTIC, block, one_thread, order  # noqa: F401
from numpy.testing import assert_allclose
from test_tlmpm_manufactured import AMPLITUDE, RATE, SIDE, TIME, body_force, displacement

from viscopoint.interactions.planes import symmetry_plane
from viscopoint.methods.mpm.geometry import Box
from viscopoint.methods.mpm.method import Discretisation, MaterialPointMethod
from viscopoint.methods.mpm.schemes import SCHEMES
from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.methods.mpm.transfers import Transfer
from viscopoint.methods.mpm.transfers.flip import Flip
from viscopoint.model.viscosity import BulkViscosity

pytestmark = pytest.mark.usefixtures("one_thread")
SMALL = AMPLITUDE / 3  # mm; strains up to 3 %
SPLINES = pytest.mark.parametrize(("shape", "degree"), [("quadratic", 2), ("cubic", 3)])


def error(cells: int, shape: str, transfer: Transfer, amplitude: float = SMALL) -> float:
    """Return the root mean square error of the points' positions, per amplitude."""
    cell = SIDE / cells
    body = block(cell, cells, cells, cells)
    walls = tuple(symmetry_plane(axis, place) for axis in range(3) for place in (0.0, SIDE))
    choices = Discretisation(
        cell, Box((0.0, 0.0, 0.0), (SIDE, SIDE, SIDE)), SHAPES[shape].fitted(0.5), SCHEMES["musl"], transfer, COURANT,
        BulkViscosity(0.0, 0.0),
    )  # fmt: skip
    method = MaterialPointMethod(body, ELASTIC, walls, choices, np.zeros_like(body.position))
    count = int(np.ceil(TIME / method.stable_step() * 1.3))
    dt = TIME / count
    method.points.velocity[:] = amplitude * RATE * np.sin(np.pi * body.position / SIDE) * np.cos(0.5 * RATE * dt)
    for step in range(count):
        method.points.velocity[:] += dt * body_force(body.position, step * dt, amplitude)
        method.advance(dt)
    missed = method.points.position - body.position - displacement(body.position, TIME, amplitude)
    return float(np.sqrt((missed**2).mean())) / amplitude


def dispersed(cells: int, degree: int) -> float:
    """Return the error that splines make by letting the wave lag: ω = c k (1 - D (kh)²), as in ``test_mpm_splines``."""
    lag = ((degree + 1) / 12 - (COURANT / 1.3) ** 2 / 24) * (np.pi / cells) ** 2
    return float(lag * RATE * TIME * abs(np.cos(RATE * TIME)) / np.sqrt(2))


@SPLINES
def test_manufactured_vibration_lags_by_no_more_than_the_splines_dispersion(shape: str, degree: int) -> None:
    errors = [error(cells, shape, Flip(0.0)) for cells in (4, 8, 16)]
    # the next terms: the walls' cells, where the filter is another, a share kh, as much again for the strain of 3 %
    assert_allclose(errors[-1], dispersed(16, degree), rtol=np.pi / 16 + 0.03)
    assert 1.7 < order(errors[1:]) < 2.1


@pytest.mark.long
@SPLINES
def test_manufactured_vibration_converges_to_second_order_with_splines(shape: str, degree: int) -> None:
    errors = [error(cells, shape, Flip(0.0)) for cells in (16, 32)]
    assert_allclose(errors[-1], dispersed(32, degree), rtol=np.pi / 32 + 0.03)
    assert order(errors) > 1.9
