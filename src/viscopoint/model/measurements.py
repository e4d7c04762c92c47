"""Lengths that a person would measure on the rod, from the positions of its points.

- The **profile** is the rod's outline: for each layer of material, the mean height of its outer points and the radius
  of the surface. Points of a lattice stand inside it, from R0 = R - spacing to R at the start: the straight line
  through their present over their first distances from the axis, fitted by least squares, is read at R. (Present times
  R / R0 is off by 1 % where a mushroom's foot is stretched unevenly.) Nodes on the surface show it by their mean.
- The **contact radius** is the greatest of the surface no higher above the lowest point than
  ``Surface.contact_height``, so of what is on the wall, or would touch it first. From a layer that is on the wall to
  the next the outline is straight. Nodes and points that stand on the surface know that to 0.1 % of the radius in
  height, and so whether a rim is lifted by some micrometres; points of a lattice know it to half a spacing, and take
  such a rim for touching.
- The **impact face's radius** is that of the lowest layer of material. With friction the side rolls onto the wall, and
  the contact is larger; a rim that curls up makes it smaller.
- The **greatest radius** is the largest of all layers.
- The **length** runs from the lowest point of the impact face to the highest of the rear face. A lattice ends half a
  spacing beyond its last layer: each column is prolonged by half the present distance of its last two points, so that
  an undeformed rod of n layers measures n spacings.
- A length that would be read from points some of which are lost (outside the box, or of deleted elements alone) is not
  a number.
"""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.model.body import Surface

FLIES = 0.5  # a point that is this share nearer to or farther from the axis than its layer is no longer the surface
LEVEL = 1e-6  # of the rod's radius: distances from the axis that differ by less are one


class Measurements(NamedTuple):
    """Lengths in mm."""

    length: float
    contact_radius: float
    impact_face_radius: float
    greatest_radius: float
    lowest_point: float  # of the points themselves
    highest_point: float
    widest_point: float  # distance from the axis


# These are plain loops: what reads results runs them as they are, and ``energy_balance`` compiles them.


def profile(surface: Surface, position: Array) -> tuple[Array, Array]:
    """Return height and radius of each layer [mm]; points at not-a-number are left out."""
    layers = len(surface.ring)
    height, radius = np.empty(layers), np.empty(layers)
    outline(surface.ring, surface.start, surface.radius, float(np.var(surface.start)), position, height, radius)
    return height, radius


def outline(
    ring: Indices, start: Array, radius_at_start: float, variance: float, position: Array, height: Array, radius: Array
) -> None:
    """Find height and radius of each layer; ``variance`` is that of ``start``."""
    layers, around = ring.shape
    for layer in range(layers):
        height[layer] = radius[layer] = np.nan
        up, swell, seen = 0.0, 0.0, 0
        for c in range(around):
            p = ring[layer, c]
            if p >= 0 and np.isfinite(position[p, 0]):
                up += position[p, 2]
                swell += np.hypot(position[p, 0], position[p, 1]) / start[c]
                seen += 1
        if seen == 0:
            continue
        height[layer], swell = up / seen, swell / seen
        count, now, middle, mixed, square = 0, 0.0, 0.0, 0.0, 0.0
        for c in range(around):
            p = ring[layer, c]
            if p >= 0 and np.isfinite(position[p, 0]):
                away = np.hypot(position[p, 0], position[p, 1])
                if not abs(away / start[c] - swell) > FLIES * swell:
                    now, middle, count = now + away, middle + start[c], count + 1
        if count == 0:
            continue
        now, middle = now / count, middle / count
        for c in range(around):
            p = ring[layer, c]
            if p >= 0 and np.isfinite(position[p, 0]):
                away = np.hypot(position[p, 0], position[p, 1])
                if not abs(away / start[c] - swell) > FLIES * swell:
                    mixed += (start[c] - middle) * away
                    square += (start[c] - middle) ** 2
        mixed, square = mixed / count, square / count
        # too few points, or all from equally far out, make no line
        line = count > 0.5 * around and square > 0.5 * variance and square > (LEVEL * radius_at_start) ** 2
        slope = mixed / square if line else now / middle
        radius[layer] = now + slope * (radius_at_start - middle)


def measure(surface: Surface, position: Array) -> Measurements:
    """Measure the rod; see the module's words on how."""
    return Measurements(*measured(surface, position, float(np.var(surface.start)), room(surface)))


def room(surface: Surface) -> Array:
    """Return memory for an outline, as ``measured`` wants it."""
    return np.empty((2, len(surface.impact_face) + len(surface.ring)))


def measured(surface: Surface, position: Array, variance: float, memory: Array) -> tuple[float, ...]:
    """Return the numbers of ``measure``; ``variance`` is that of ``surface.start``, ``memory`` from ``room``."""
    lowest, highest, widest, nothing = np.inf, -np.inf, 0.0, 0.0
    for p in range(len(position)):
        x, y, z = position[p, 0], position[p, 1], position[p, 2]
        lowest, highest, widest = min(lowest, z), max(highest, z), max(widest, x * x + y * y)
        if not np.isfinite(x + y + z):
            nothing = np.nan
    low_end, high_end = np.inf, -np.inf
    for column in range(len(surface.impact_face)):
        low_end = np.minimum(low_end, end(surface.impact_face, column, position, surface.end_overhang))
    for column in range(len(surface.rear_face)):
        high_end = np.maximum(high_end, end(surface.rear_face, column, position, surface.end_overhang))
    before = len(surface.impact_face)
    height, radius = memory[0], memory[1]
    outline(surface.ring, surface.start, surface.radius, variance, position, height[before:], radius[before:])
    contact, face, greatest = np.nan, np.nan, np.nan
    if not has_lost_points(surface.ring, position):
        face, greatest = radius[before], radius[before]
        for layer in range(before, len(radius)):
            greatest = np.maximum(greatest, radius[layer])
        contact = contact_radius(surface, position, height, radius)
    return high_end - low_end, contact, face, greatest, lowest + nothing, highest + nothing, np.sqrt(widest) + nothing


def end(columns: Indices, column: int, position: Array, overhang: float) -> float:
    """Return where a column of points ends."""
    last, inner = position[columns[column, 0], 2], position[columns[column, 1], 2]
    return last + overhang * (last - inner)


def has_lost_points(ring: Indices, position: Array) -> bool:
    """Return whether one of the surface's points was lost."""
    for layer in range(ring.shape[0]):
        for c in range(ring.shape[1]):
            if ring[layer, c] >= 0 and np.isnan(position[ring[layer, c], 2]):
                return True
    return False


def contact_radius(surface: Surface, position: Array, height: Array, radius: Array) -> float:
    """Return the greatest radius of the surface no higher above its lowest point than ``surface.contact_height`` [mm].

    The outline's layers are the last entries of height and radius; those before them are overwritten.
    """
    face, first, most = surface.impact_face, len(surface.impact_face), np.inf
    for column in range(first):
        most = np.minimum(most, position[face[column, 0], 2])
    for layer in range(first, len(height)):
        most = np.minimum(most, height[layer])
    if np.isnan(most):
        return most
    most += surface.contact_height
    if height[first] > most:  # the rim is off the wall: only a part of the impact face is on it
        first = add_impact_face(surface, position, height, radius)
        most = np.inf  # of the mean of an uneven rim, not of its lowest node
        for n in range(first, len(height)):
            most = np.minimum(most, height[n])
        most += surface.contact_height
    found = np.nan
    for n in range(first, len(height)):
        if height[n] > most:
            continue
        found = np.fmax(found, radius[n])
        for step in (-1, 1):  # the straight line to a neighbour that is higher, up or down the outline
            beyond = n + step
            if first <= beyond < len(height) and height[beyond] > most:
                share = (most - height[n]) / (height[beyond] - height[n])
                found = np.fmax(found, radius[n] + share * (radius[beyond] - radius[n]))
    return found


def add_impact_face(surface: Surface, position: Array, height: Array, radius: Array) -> int:
    """Put the impact face's points within its rim before the outline, from the axis outwards; return where they begin.

    They are mostly in that order, if they were at the start: then each finds its place at once.
    """
    last = len(surface.impact_face) - 1
    first = last + 1
    for column in range(last, -1, -1):
        p = surface.impact_face[column, 0]
        rim = False
        for c in range(surface.ring.shape[1]):
            rim = rim or surface.ring[0, c] == p
        if rim:
            continue
        away, place = np.hypot(position[p, 0], position[p, 1]), first - 1
        while place < last and radius[place + 1] < away:
            height[place], radius[place] = height[place + 1], radius[place + 1]
            place += 1
        height[place], radius[place] = position[p, 2], away
        first -= 1
    return first


LOOPS = (outline, end, has_lost_points, add_impact_face, contact_radius)  # that ``measured`` calls
