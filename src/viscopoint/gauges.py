"""Lengths that a person would measure on the rod, from the positions of its points.

- The **profile** is the rod's outline: for each layer of material, the mean height of its outer points and the radius
  of the surface. Points of a lattice stand inside it, from R0 = R - spacing to R at the start: the straight line
  through their present over their first distances from the axis, fitted by least squares, is read at R. (Present times
  R / R0 is off by 1 % where a mushroom's foot is stretched unevenly.) Nodes on the surface show it by their mean.
- The **foot radius** is that of the lowest layer, the **greatest radius** the largest of all.
- Points that were lost, and what belongs to deleted elements only, count no more: the lowest layer is then the lowest
  that is left.
- The **length** runs from the lowest point of the foot to the highest of the tail. A lattice ends half a spacing
  beyond its last layer: each column is prolonged by half the present distance of its last two points, so that an
  undeformed rod of n layers measures n spacings.
"""

from typing import NamedTuple

import numpy as np

from viscopoint.arrays import Array, Indices
from viscopoint.body import Surface

FLIES = 0.5  # a point that is this share nearer to or farther from the axis than its layer is no longer the surface
LEVEL = 1e-6  # of the rod's radius: distances from the axis that differ by less are one


class Gauges(NamedTuple):
    """Lengths in mm."""

    length: float
    foot_radius: float
    greatest_radius: float
    lowest_point: float  # of the points themselves
    highest_point: float
    widest_point: float  # distance from the axis


def profile(surface: Surface, position: Array) -> tuple[Array, Array]:
    """Return height and radius of each layer [mm]; points at not-a-number are left out."""
    ring = np.where((surface.ring < 0)[..., None], np.nan, position[surface.ring])
    now = np.hypot(ring[..., 0], ring[..., 1])
    with np.errstate(invalid="ignore", divide="ignore"):
        swell = now / surface.start
        flies = np.abs(swell - _mean(swell)[:, None]) > FLIES * _mean(swell)[:, None]
        now = np.where(flies, np.nan, now)
        start = np.where(np.isfinite(now), surface.start, np.nan)
        middle, radius = _mean(start), _mean(now)
        apart = start - middle[:, None]
        spread = _mean(apart**2)
        # too few points, or all from equally far out, make no line
        enough = np.isfinite(now).mean(axis=1) > 0.5
        line = enough & (spread > 0.5 * np.var(surface.start)) & (spread > (LEVEL * surface.radius) ** 2)
        slope = np.where(line, _mean(apart * now) / spread, radius / middle)
    return _mean(ring[..., 2]), radius + slope * (surface.radius - middle)


def measure(surface: Surface, position: Array) -> Gauges:
    """Measure the rod; see the module's words on how."""
    _, radius = profile(surface, position)
    x, y, z = position.T
    # fmax and fmin leave out not-a-number
    tail, foot = _ends(surface.tail, z, surface.reach), _ends(surface.foot, z, surface.reach)
    lowest, highest = np.fmin.reduce(z), np.fmax.reduce(z)
    top, bottom = np.fmax.reduce(tail), np.fmin.reduce(foot)
    there = radius[np.isfinite(radius)]
    return Gauges(
        length=float((top if np.isfinite(top) else highest) - (bottom if np.isfinite(bottom) else lowest)),
        foot_radius=float(there[0]) if len(there) else np.nan,
        greatest_radius=float(np.fmax.reduce(radius)),
        lowest_point=float(lowest),
        highest_point=float(highest),
        widest_point=float(np.sqrt(np.fmax.reduce(x**2 + y**2))),
    )


def _ends(columns: Indices, z: Array, reach: float) -> Array:
    last, inner = z[columns[:, 0]], z[columns[:, 1]]
    return last + reach * (last - inner)


def _mean(values: Array) -> Array:
    """Average each row over its finite values; not-a-number where there is none."""
    finite = np.isfinite(values)
    total = np.where(finite, values, 0.0).sum(axis=1)
    return np.divide(total, finite.sum(axis=1), out=np.full(len(values), np.nan), where=finite.any(axis=1))
