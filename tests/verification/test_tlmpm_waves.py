"""Waves in columns of total Lagrangian points that hit a wall or ring, against exact solutions (verification.md).

The column is a chain of masses and springs (see ``lagrangian``); errors are those of a dispersed front (``fronts``).
"""

from functools import cache

import conserved
import laplace
import numpy as np
import pytest
from bricks import fitted
from columns import COURANT, DENSITY, LENGTH, MODULI, advance, one_thread, order, viscoelastic  # noqa: F401
from fronts import errors
from lagrangian import DISPERSION, Array, column, each_volume, levels, upward
from numpy.testing import assert_allclose

from viscopoint.interactions.planes import symmetry_plane
from viscopoint.methods.tlmpm.method import TotalLagrangianMethod

pytestmark = pytest.mark.usefixtures("one_thread")
SPEED = 1e-4  # mm/ms: strains of 1e-7, which no error here comes close to
TIMES = (0.02, 0.045)  # ms; the front is before, then back from the free end
MESHES = (50, 100, 200)
each_decay = pytest.mark.parametrize("decay", [6.5, 65.0, 650.0])  # 1/ms


@cache
def impact(decay: float, cells: int) -> dict[float, tuple[Array, Array, Array, float]]:
    """Let a column hit the wall; return place, displacement and velocity of the planes of nodes, and wall impulse."""
    method = column(cells, viscoelastic(decay), motion=upward(lambda z: np.full_like(z, -SPEED)))
    start, now, states = levels(method, method.reference[:, 2]), 0.0, {}
    for time in TIMES:
        advance(method, time - now)
        now = time
        place, velocity = (levels(method, values[:, 2]) for values in (method.nodes.position, method.nodes.velocity))
        states[time] = (start, place - start, velocity, float(method.totals().impulse[2]) / (LENGTH / cells) ** 2)
    return states


@each_decay
@pytest.mark.parametrize("time", TIMES)
def test_velocity_and_displacement_err_by_no_more_than_dispersion(decay: float, time: float) -> None:
    solid, found = laplace.confined(*MODULI, decay), []
    for cells in MESHES:
        x, displacement, velocity, _ = impact(decay, cells)[time]
        missed = velocity / SPEED - laplace.velocity(solid, LENGTH, 1.0, x, time)
        astray = displacement / SPEED - laplace.displacement(solid, LENGTH, 1.0, x, time)
        found.append([np.abs(missed).mean(), np.abs(astray).mean()])
        if decay < 100.0:
            allowed = errors(solid, LENGTH, DISPERSION * (LENGTH / cells) ** 2, time, x)
            assert found[-1][0] < 1.1 * allowed[0]
            assert found[-1][1] < 1.1 * allowed[1]
    velocity, displacement = np.transpose(found)
    if decay < 100.0:
        assert 0.35 < order(list(velocity)) < 0.75  # 1/2 of a jump
        assert 1.1 < order(list(displacement)) < 1.6  # 4/3
    else:
        assert 1.2 < order(list(displacement)) < 2.2  # the front has gone, or nearly


@each_decay
@pytest.mark.parametrize("cells", MESHES)
def test_impulse_of_the_wall_is_exact_to_second_order(decay: float, cells: int) -> None:
    """The foot's momentum goes to the node above: the wall's push begins late by (h/c) / 4 in the mean, and smoothly.

    What is left is that node's ringing on the first cell: the impulse of a mass of 3/2 rho h, at no more than v0,
    against waves that leave it. It falls with the tail of a dispersed front, tau^(-3/2).
    """
    solid = laplace.confined(*MODULI, decay)
    for time in TIMES:
        found = impact(decay, cells)[time][3]
        tau = 2 * solid.speed * time * cells / LENGTH
        allowed = 1.5 * tau**-1.5 * DENSITY * SPEED * LENGTH / cells
        allowed += DENSITY * SPEED * solid.decay / solid.speed * (LENGTH / cells) ** 2  # relaxation meanwhile
        assert_allclose(found, laplace.wall_impulse(solid, LENGTH, SPEED, time), rtol=0, atol=allowed)


@pytest.mark.parametrize("cells", [50, 100])
def test_elastic_column_rebounds_without_adhesion_loss_or_gain(cells: int) -> None:
    method = column(cells, motion=upward(lambda z: np.full_like(z, -SPEED)))
    start = method.totals()
    (_, left), now = conserved.assert_rebounds_without_adhesion(method, cells, DISPERSION, late=1.0)
    assert now.contact < 1e-3 * start.kinetic / cells
    # leapfrog's swing of the front's shortest waves, (w dt)^2 / 4 < C^2 of what is in about one cell
    assert_allclose(left, 1.0, rtol=0, atol=COURANT**2 / cells)
    assert levels(method, method.nodes.position[:, 2])[0] > 0.0
    assert_allclose(method.nodes.normal_mass, method.nodes.mass, rtol=1e-12)  # all mass is back where it was


def ringing(cells: int, decay: float, volume: str) -> TotalLagrangianMethod:
    """Return a column held at its foot that starts to ring as sin(kz), k = pi/2L."""
    k = np.pi / (2 * LENGTH)
    motion = upward(lambda z: SPEED * np.sin(k * z))
    return column(cells, viscoelastic(decay), (symmetry_plane(2, 0.0),), motion, volume)


@each_volume
@pytest.mark.parametrize("decay", [0.0, 6.5, 65.0, 650.0])
def test_column_rings_and_damps_as_the_standard_solid(decay: float, volume: str) -> None:
    solid = laplace.confined(*MODULI, decay)
    square = (np.pi / (2 * LENGTH) * solid.speed) ** 2
    roots = np.roots([1.0, solid.decay, square, square * solid.a])
    exact = complex(roots[roots.imag.argmax()])
    slope = 2 * square * (exact + solid.a) / (3 * exact**2 + 2 * exact * solid.decay + square)  # ds per dw0/w0
    found = []
    for cells in (16, 32):
        method, signal = ringing(cells, decay, volume), list[float]()
        mode = np.sin(np.pi / (2 * LENGTH) * levels(method, method.reference[:, 2]))
        weight = mode / SPEED * np.where(np.arange(cells + 1) == cells, 0.5, 1.0)
        dt = method.stable_step()
        every = cells // 8
        for _ in range(int(2 * np.pi / exact.imag / dt / every)):
            signal.append(float(levels(method, method.nodes.velocity[:, 2]) @ weight))
            for _ in range(every):
                method.advance(dt)
        times = np.linspace(0.0, (len(signal) - 1) * every * dt, len(signal))
        s = fitted(times, np.array(signal), roots)
        found.append((s - exact) / (abs(slope) * (np.pi / 2 / cells) ** 2))
    # dispersion lowers w0 by DISPERSION (kh)^2; the next term is (kh)^2 < 1 % of it
    assert_allclose(np.abs(found), DISPERSION, rtol=0.02)
    if not decay:
        assert_allclose([s.imag for s in found], -DISPERSION, rtol=0.01)
