"""Lengths that a person would measure on the rod, from the positions of its points.

- The **profile** is the rod's outline: for each layer of material, its mean height and its radius averaged around the
  circumference. Points of a lattice stand inside the surface; a point that starts at radius R0 shows the surface at
  its present radius times R / R0.
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
    radius = np.hypot(ring[..., 0], ring[..., 1]) * surface.swell
    return _mean(ring[..., 2]), _mean(radius)


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
