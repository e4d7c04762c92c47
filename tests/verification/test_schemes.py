"""Standing waves: the schemes against their own dispersion relation, the exact waves, and each other.

In a free column every wave cos(kz) of the lattice stays what it is, but for the points' motion within cells: a point's
velocity is u1 cos(kz) + u2 cos((2 pi/h - k) z), and nodes and points see each other through s = (s1, s2),

    s1 = 3/4 cos(kh/4) + 1/4 cos(3kh/4),    s2 = 3/4 sin(kh/4) - 1/4 sin(3kh/4),    |s|^2 = F (see ``columns``).

That makes a step a handful of scalar equations, which the three-dimensional code has to follow almost to rounding.
"""

from functools import cache
from typing import Any, NamedTuple

import laplace
import numpy as np
import pytest
from columns import (
    BULK,
    COURANT,
    DENSITY,
    DISPERSION,
    ELASTIC,
    LENGTH,
    MODULI,
    SHEAR_LONG,
    SHEAR_SHORT,
    Array,
    column,
    layers,
    one_thread,  # noqa: F401
    order,
    viscoelastic,
)
from numpy.testing import assert_allclose

from viscopoint.interactions.planes import symmetry_plane
from viscopoint.methods.mpm.method import MaterialPointMethod
from viscopoint.model.method import Totals

pytestmark = pytest.mark.usefixtures("one_thread")
SPEED = 1e-4  # mm/ms: strains of 1e-7, what is not linear is of that size
STRAIN = SPEED / 858.293
MESHES = (24, 48, 96)  # cells


def ringing(
    cells: int, k: float, decay: float = 0.0, shape: Any = np.cos, **choices: Any
) -> tuple[MaterialPointMethod, Array]:
    """Return a column that starts to ring as cos(kz) with free ends or sin(kz) on a held foot, and that mode."""
    ends = () if shape is np.cos else (symmetry_plane(2, 0.0),)
    law = viscoelastic(decay) if decay else ELASTIC
    method = column(cells, law, ends, lambda z: SPEED * shape(k * z), **choices)
    return method, shape(k * layers(method.body.position[:, 2]))


def amplitude(method: MaterialPointMethod, mode: Array) -> float:
    return float(layers(method.points.velocity[:, 2]) @ mode / (mode @ mode)) / SPEED


class Scheme(NamedTuple):
    """One wave of the linear scheme."""

    name: str
    pic: float
    decay: float
    k: float
    cell: float
    dt: float

    def amplitudes(self, steps: int) -> Array:
        kh = self.k * self.cell
        seen = np.array([3 * np.cos(kh / 4) + np.cos(3 * kh / 4), 3 * np.sin(kh / 4) - np.sin(3 * kh / 4)]) / 4
        slope = 2 / self.cell * np.sin(kh / 2)
        u, spring, arm, found = np.array([1.0, 0.0]), 0.0, 0.0, []
        for _ in range(steps):
            if self.name == "usf":
                spring, arm = self.stressed(spring, arm, slope * seen @ u)
            kick = -self.dt / DENSITY * slope * (spring + arm)
            node = seen @ u + kick
            if self.name == "usl":
                spring, arm = self.stressed(spring, arm, slope * node)
            u = (1 - self.pic) * (u + seen * kick) + self.pic * seen * node
            if self.name == "musl":
                spring, arm = self.stressed(spring, arm, slope * seen @ u)
            found.append(u[0])
        return np.array(found)

    def stressed(self, spring: float, arm: float, rate: float) -> tuple[float, float]:
        """Integrate dq/dt = -decay q + M rate of spring and Maxwell arm exactly over a step."""
        if not self.decay:
            return spring + (BULK + 4 * SHEAR_SHORT / 3) * self.dt * rate, 0.0
        left = np.exp(-self.decay * self.dt)
        grown = 4 * (SHEAR_SHORT - SHEAR_LONG) / 3 * (1 - left) / self.decay
        return spring + (BULK + 4 * SHEAR_LONG / 3) * self.dt * rate, left * arm + grown * rate


@pytest.mark.parametrize("scheme", ["musl", "usl", "usf"])
@pytest.mark.parametrize("pic", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("decay", [0.0, 65.0])
@pytest.mark.parametrize("waves", [1, 3])
def test_scheme_follows_its_discrete_dispersion_relation(scheme: str, pic: float, decay: float, waves: int) -> None:
    cells, steps, k = 8, 100, waves * np.pi / LENGTH
    method, mode = ringing(cells, k, decay, scheme=scheme, pic=pic)
    dt, found = method.stable_step(), []
    for _ in range(steps):
        method.advance(dt)
        found.append(amplitude(method, mode))
    expected = Scheme(scheme, pic, decay, k, LENGTH / cells, dt).amplitudes(steps)
    # 100 steps of 1/2 Courant number: each may turn the phase by the strain times w dt < 1
    assert_allclose(found, expected, rtol=0, atol=steps * STRAIN)


@cache
def period(scheme: str, cells: int, safety: float) -> tuple[Array, Array]:
    """Return phase (from 0 to about 2 pi) and amplitude of a free elastic column's fundamental vibration."""
    k = np.pi / LENGTH
    method, mode = ringing(cells, k, scheme=scheme, safety=safety)
    dt, found = method.stable_step(), [1.0]
    for _ in range(int(2 * cells / safety)):
        method.advance(dt)
        found.append(amplitude(method, mode))
    phase: Array = k * dt * 858.293 * np.linspace(0, len(found) - 1, len(found))
    return phase, np.array(found)


@pytest.mark.parametrize("scheme", ["musl", "usl", "usf"])
def test_scheme_converges_to_the_standing_wave(scheme: str) -> None:
    errors = []
    for cells in MESHES:
        phase, found = period(scheme, cells, COURANT)
        errors.append(float(np.abs(found - np.cos(phase)).max()))
    # stress and velocity are known half a step apart, and start together: the phase is off by w dt / 2, and dispersion
    # adds 2 pi DISPERSION (kh)^2. USL damps besides, by less: (1 - F) (w dt)^2 / 2 per step.
    kh = np.pi / MESHES[-1]
    assert errors[-1] < 1.1 * (kh * COURANT / 2 + 2 * np.pi * DISPERSION * kh**2)
    assert 0.9 < order(errors) < 1.4


@pytest.mark.parametrize(("one", "other"), [("musl", "usl"), ("musl", "usf"), ("usl", "usf")])
def test_schemes_agree_to_first_order(one: str, other: str) -> None:
    def difference(cells: int, safety: float) -> float:
        return float(np.abs(period(one, cells, safety)[1] - period(other, cells, safety)[1]).max())

    fine = [difference(cells, COURANT) for cells in MESHES]
    assert fine[-1] < 1.1 * np.pi / MESHES[-1] * COURANT  # they differ by w dt in phase at most
    assert 0.9 < order(fine) < 3.2  # MUSL and USL differ by the damping alone: (kh)^2 w dt, of third order
    short = [difference(24, safety) for safety in (0.4, 0.2, 0.1)]
    assert 0.9 < order(short) < 1.1


def total(sums: Totals) -> float:
    return sums.kinetic + sums.stored


def energies(periods: int, cells: int = 32, **choices: Any) -> tuple[Array, float]:
    """Return the mean energy of each half period, relative to the start, and w dt."""
    method, _ = ringing(cells, np.pi / LENGTH, **choices)
    start, dt, half = total(method.totals()), method.stable_step(), round(cells / choices["safety"])
    means = []
    for _ in range(2 * periods):
        energy = 0.0
        for _ in range(half):
            method.advance(dt)
            energy += total(method.totals()) / half
        means.append(energy / start)
    return np.array(means), np.pi / LENGTH * 858.293 * dt


@pytest.mark.parametrize("scheme", ["musl", "usf"])
def test_flip_keeps_the_energy_of_a_vibration(scheme: str) -> None:
    means, turn = energies(5, scheme=scheme, safety=0.4)
    # leapfrog is symplectic: energy swings by w dt / 2 and does not drift; a half period misses its end by dispersion
    assert np.abs(means - 1).max() < turn
    assert np.abs(means - means[0]).max() < 1e-3


def test_usl_and_pic_damp_a_vibration_at_their_own_rates() -> None:
    """The velocity that strains the points (USL) or moves them (PIC) is not the filtered one that F leaves to FLIP.

    USL: stress gains (1 - F) dt M grad(f / rho), which damps the energy by (1 - F) (w dt)^2 each step.
    PIC: velocity loses (1 - F) each step, and energy, half of it kinetic, as much. Here 1 - F = 3/16 (kh)^2.
    """
    lost = 3 / 16 * (np.pi / 32) ** 2
    means, turn = energies(5, scheme="usl", safety=0.4)
    steps = round(32 / 0.4)
    assert (np.diff(means) < 0).all()
    assert_allclose(-np.log(means[-1] / means[0]), 9 * steps * lost * turn**2, rtol=0.05)
    means, _ = energies(2, scheme="musl", safety=0.1, pic=1.0)
    assert (np.diff(means) < 0).all()
    assert_allclose(-np.log(means[-1] / means[0]), 3 * 320 * lost, rtol=0.05)


def modes(signal: Array, interval: float, number: int) -> Array:
    """Return the exponents of a sum of exponentials (Prony)."""
    past = np.column_stack([signal[i : len(signal) - number + i] for i in range(number)])
    weights = np.linalg.lstsq(past, -signal[number:], rcond=None)[0]
    return np.log(np.roots(np.r_[1.0, weights[::-1]]).astype(complex)) / interval


@pytest.mark.parametrize("decay", [0.0, 6.5, 65.0, 650.0])
@pytest.mark.parametrize("end", ["free", "held"])
def test_column_vibrates_and_damps_as_the_standard_solid(decay: float, end: str) -> None:
    solid = laplace.confined(*MODULI, decay)
    k = np.pi / LENGTH if end == "free" else np.pi / (2 * LENGTH)
    frequency = k * solid.speed
    roots = np.roots([1.0, decay, frequency**2, frequency**2 * solid.a])
    exact = roots[roots.imag.argmax()]
    turning, damping = [], []
    for cells in MESHES:
        found = vibration(decay, cells, k, end)
        turning.append(1 - found.imag / exact.imag)
        damping.append(abs(found.real - exact.real) / abs(exact))
    short = DISPERSION * (k * LENGTH / MESHES[-1]) ** 2
    if end == "free":  # a mirror of the lattice: only dispersion is left; its next term is (kh)^4
        assert_allclose(turning[-1], short, rtol=0.07)
    assert 0 < turning[-1] < 1.5 * short  # the held end adds its own second-order part
    assert 1.8 < order(turning) < 2.3
    # the mode's damping depends on its frequency, whose relative error is (kh)^2
    assert damping[-1] < short


def vibration(decay: float, cells: int, k: float, end: str) -> complex:
    """Return the exponent of the column's fundamental vibration [1/ms]."""
    method, mode = ringing(cells, k, decay, np.cos if end == "free" else np.sin)
    samples, every, dt = [1.0], cells // (6 if end == "free" else 3), method.stable_step()
    for _ in range(24):  # to an elastic column's period
        for _ in range(every):
            method.advance(dt)
        samples.append(amplitude(method, mode))
    found = modes(np.array(samples), every * dt, 3 if decay else 2)
    return complex(found[found.imag.argmax()])
