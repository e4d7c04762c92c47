"""Lengths that a person would measure on the rod, from the positions of its points.

- The **profile** is the rod's outline: for each layer of material, the mean height of its outer points and the radius
  of the surface. Points of a lattice stand inside it, from R0 = R - spacing to R at the start: the straight line
  through their present over their first distances from the axis, fitted by least squares, is read at R. (Present times
  R / R0 is off by 1 % where a mushroom's foot is stretched unevenly.) Nodes on the surface show it by their mean.
- The **contact radius** is the greatest of the surface no higher above the lowest point than ``Surface.near``, so of
  what is on the wall, or would touch it first. From a layer that is on the wall to the next the outline is straight.
  Nodes and points that stand on the surface know that to 0.1 % of the radius in height, and so whether a rim is lifted
  by some micrometres; points of a lattice know it to half a spacing, and take such a rim for touching.
- The **impact face's radius** is that of the lowest layer of material. With friction the side rolls onto the wall, and
  the contact is larger; a rim that curls up makes it smaller.
- The **greatest radius** is the largest of all layers.
- The **length** runs from the lowest point of the foot to the highest of the tail. A lattice ends half a spacing
  beyond its last layer: each column is prolonged by half the present distance of its last two points, so that an
  undeformed rod of n layers measures n spacings.
- A length that would be read from points some of which are lost (outside the box, or of deleted elements alone) is not
  a number.
"""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.model.body import Surface

FLIES = 0.5  # a point that is this share nearer to or farther from the axis than its layer is no longer the surface
LEVEL = 1e-6  # of the rod's radius: distances from the axis that differ by less are one


class Gauges(NamedTuple):
    """Lengths in mm."""

    length: float
    contact_radius: float
    impact_face_radius: float
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
    height, radius = profile(surface, position)
    x, y, z = position.T
    tail, foot = _ends(surface.tail, z, surface.reach), _ends(surface.foot, z, surface.reach)
    ring_is_whole = not np.isnan(position[surface.ring[surface.ring >= 0], 2]).any()
    return Gauges(
        length=float(tail.max() - foot.min()),  # not a number if one of them is not
        contact_radius=_contact_radius(surface, position, height, radius) if ring_is_whole else np.nan,
        impact_face_radius=float(radius[0]) if ring_is_whole else np.nan,
        greatest_radius=float(radius.max()) if ring_is_whole else np.nan,
        lowest_point=float(z.min()),
        highest_point=float(z.max()),
        widest_point=float(np.sqrt((x**2 + y**2).max())),
    )


def _contact_radius(surface: Surface, position: Array, height: Array, radius: Array) -> float:
    """Return the greatest radius of the surface no higher above its lowest point than ``surface.near`` [mm]."""
    face = position[surface.foot[:, 0]]
    most = min(float(face[:, 2].min()), float(height.min())) + surface.near
    if height[0] > most:  # the rim is off the wall: only a part of the impact face is on it
        inside = face[~np.isin(surface.foot[:, 0], surface.ring[0])]
        from_axis = np.hypot(inside[:, 0], inside[:, 1])
        order = np.argsort(from_axis, kind="stable")
        radius, height = np.append(from_axis[order], radius), np.append(inside[order, 2], height)
    on = height <= most
    touching, found = np.flatnonzero(on), [np.nan]
    found += radius[touching].tolist()
    for here, beyond in ((-1, 1), (1, -1)):  # the straight line to a neighbour that is higher, up or down the outline
        there = touching + beyond
        there = there[(there >= 0) & (there < len(on))]
        there = there[~on[there]]
        share = (most - height[there + here]) / (height[there] - height[there + here])
        found += (radius[there + here] + share * (radius[there] - radius[there + here])).tolist()
    return float(np.fmax.reduce(found))


def _ends(columns: Indices, z: Array, reach: float) -> Array:
    last, inner = z[columns[:, 0]], z[columns[:, 1]]
    return last + reach * (last - inner)


def _mean(values: Array) -> Array:
    """Average each row over its finite values; not-a-number where there is none."""
    finite = np.isfinite(values)
    total = np.where(finite, values, 0.0).sum(axis=1)
    return np.divide(total, finite.sum(axis=1), out=np.full(len(values), np.nan), where=finite.any(axis=1))
