"""Impact of a bar of a standard linear solid on a rigid wall, exactly (one dimension, small strain).

With c(s) = c0 sqrt((s + a) / (s + b)) the bar that hits the wall x = 0 at speed v0 and is free at x = L moves at

    V(x, s) = -v0/s + (v0/s) cosh(s (L - x) / c) / cosh(s L / c)
            = -v0/s + (v0/s) sum_n (-1)^n [exp(-s (2 n L + x) / c) + exp(-s (2 (n + 1) L - x) / c)].

Each term is a wave from an image of the impact. Its front exp(-s d / c0) is taken out and the smooth rest inverted by
Talbot's contour, so that the solution has sharp fronts and no ripples.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class StandardSolid(NamedTuple):
    """A bar's law in one dimension: M(t) = long + (short - long) exp(-decay t)."""

    density: float  # g/mm^3
    short: float  # MPa
    long: float  # MPa
    decay: float  # b, 1/ms

    @property
    def a(self) -> float:
        return self.decay * self.long / self.short

    @property
    def speed(self) -> float:
        """c0, of the front, mm/ms."""
        return float(np.sqrt(self.short / self.density))

    def front(self, distance: float) -> float:
        """Return which share of a front is left after a distance."""
        return float(np.exp(-(self.decay - self.a) * distance / (2 * self.speed)))


def confined(density: float, bulk: float, shear_short: float, shear_long: float, decay: float) -> StandardSolid:
    """Return the law of a laterally confined column (uniaxial strain)."""
    return StandardSolid(density, bulk + 4 * shear_short / 3, bulk + 4 * shear_long / 3, decay)


def thin(density: float, bulk: float, shear_short: float, shear_long: float, decay: float) -> StandardSolid:
    """Return the law of a thin rod (uniaxial stress)."""
    short, long = (9 * bulk * g / (3 * bulk + g) for g in (shear_short, shear_long))
    return StandardSolid(density, short, long, decay * (3 * bulk + shear_long) / (3 * bulk + shear_short))


def inverse(transform: Callable[[NDArray], NDArray], time: Array, terms: int = 32) -> Array:
    """Invert a Laplace transform at times > 0 (fixed Talbot, Abate & Valko 2004): singular only on s <= 0."""
    r = 2 * terms / 5 / time
    angle = np.arange(1, terms) * np.pi / terms
    cot = 1 / np.tan(angle)
    s = r[..., None] * angle * (cot + 1j)
    slope = 1 + 1j * (angle + (angle * cot - 1) * cot)
    total = 0.5 * np.exp(r * time) * np.real(transform(r + 0j))
    return r / terms * (total + (np.exp(s * time[..., None]) * transform(s) * slope).real.sum(axis=-1))


def wave(solid: StandardSolid, distance: ArrayLike, time: float, impedance: int = 0, integrals: int = 0) -> Array:
    """Invert (c/c0)^impedance exp(-s d / c) / s^(1 + integrals): the wave of a unit step, at distances d."""
    distance = np.asarray(distance, float)
    result = np.zeros(distance.shape)
    since = time - distance / solid.speed
    arrived = since > 0
    travel = (distance / solid.speed)[arrived]

    def behind_front(s: NDArray) -> NDArray:
        slowness = np.sqrt((s + solid.decay) / (s + solid.a))
        delay = travel.reshape(travel.shape + (1,) * (s.ndim - travel.ndim))
        return np.exp(-s * delay * (slowness - 1)) / (slowness**impedance * s ** (1 + integrals))

    result[arrived] = inverse(behind_front, since[arrived])
    return result


def images(solid: StandardSolid, length: float, time: float) -> int:
    """Return how many pairs of images may have sent waves by now."""
    return int(solid.speed * time / (2 * length)) + 1


def gain(solid: StandardSolid, length: float, x: ArrayLike, time: float, integrals: int = 0) -> Array:
    """Return what the impact adds to the velocity along x (its integral over time), per impact speed."""
    x = np.asarray(x, float)
    total = np.zeros(x.shape)
    for n in range(images(solid, length, time)):
        for distance in (2 * n * length + x, 2 * (n + 1) * length - x):
            total += (-1) ** n * wave(solid, distance, time, integrals=integrals)
    return total


def velocity(solid: StandardSolid, length: float, speed: float, x: ArrayLike, time: float) -> Array:
    """Return the bar's velocity along x [mm/ms]; it moved at -speed before."""
    return speed * (gain(solid, length, x, time) - 1)


def displacement(solid: StandardSolid, length: float, speed: float, x: ArrayLike, time: float) -> Array:
    """Return how far the bar has moved along x [mm]."""
    return speed * (gain(solid, length, x, time, integrals=1) - time)


def stress(solid: StandardSolid, length: float, speed: float, x: ArrayLike, time: float) -> Array:
    """Return the axial stress [MPa]."""
    x = np.asarray(x, float)
    total = np.zeros(x.shape)
    for n in range(images(solid, length, time)):
        for side, distance in ((1, 2 * n * length + x), (-1, 2 * (n + 1) * length - x)):
            total -= side * (-1) ** n * wave(solid, distance, time, impedance=1)
    return solid.density * solid.speed * speed * total


def wall_impulse(solid: StandardSolid, length: float, speed: float, time: float) -> float:
    """Return the impulse of the wall per area [MPa ms], before it would have to pull."""
    total = wave(solid, 0.0, time, impedance=1, integrals=1)
    for n in range(1, images(solid, length, time) + 1):
        total = total + 2 * (-1) ** n * wave(solid, 2 * n * length, time, impedance=1, integrals=1)
    return float(solid.density * solid.speed * speed * total)
