"""What dispersion makes of a step front.

Waves of w = c k (1 - D k^2) turn a step that ran at c for a time t into

    step(xi) = int_xi^inf Ai,    xi = (x - c t) / w,    w = (3 D c t)^(1/3).

The tail behind the front falls as |xi|^(-3/4), that of its integral over time as |xi|^(-5/4). So with D ~ h^2 the mean
error of velocity falls as w^(3/4) ~ h^(1/2), that of displacement as w^2 ~ h^(4/3).
"""

import numpy as np
from laplace import Array, StandardSolid
from scipy.special import airy, itairy

HALF = -0.409  # step = 1/2


def step(xi: Array) -> Array:
    ahead, _, behind, _ = itairy(np.abs(xi))
    return 1 / 3 + np.where(xi > 0, -ahead, behind)


def lead(xi: Array) -> Array:
    """Return the integral of step less the sharp step, from xi to infinity; in steps' time w / c."""
    return -xi * (step(xi) - (xi < 0)) - airy(xi)[1]


def width(solid: StandardSolid, dispersion: float, time: float) -> float:
    """Return w for D = ``dispersion`` [mm^2]."""
    return float(np.cbrt(3 * dispersion * solid.speed * time))


def errors(solid: StandardSolid, length: float, dispersion: float, time: float, x: Array) -> tuple[float, float]:
    """Return the mean errors of velocity and displacement [ms], per impact speed, of a bar that hit a wall.

    They are those of a front that has decayed by now, and of its reflection from the free end.
    """
    w, front = width(solid, dispersion, time), solid.front(solid.speed * time)
    xi = [(y - solid.speed * time) / w for y in (x, 2 * length - x)]
    velocity: Array = sum((step(s) - (s < 0) for s in xi), np.zeros_like(x))
    moved: Array = sum((lead(s) for s in xi), np.zeros_like(x))
    return front * float(np.abs(velocity).mean()), front * float(np.abs(moved).mean()) * w / solid.speed
