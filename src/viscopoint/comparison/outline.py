"""How far apart two outlines are.

An outline is the half section of the rod, radius over height: from the axis along the foot, up the side layer by layer
and along the tail back to the axis. Points of a lattice stand half a spacing inside the ends; like the length, the
outline is prolonged there by the line through the last two layers.
"""

from typing import NamedTuple

import numpy as np
import shapely

from viscopoint.kernels.arrays import Array
from viscopoint.results.reader import Snapshot
from viscopoint.results.run import Run

DENSE = 0.05  # share of an outline's edge after which the distance is measured again


class Apart(NamedTuple):
    """Difference of two outlines."""

    area: float  # between them, over the area of the rod's half section
    distance: float  # greatest from any place of one to the nearest of the other, mm (Hausdorff)


def outline(run: Run, snapshot: Snapshot) -> Array:
    """Return radius and height ``[n, 2]`` [mm] of the half section, from the axis at the foot to that at the tail."""
    height, radius = run.profile(snapshot)
    side = np.column_stack([radius, height])
    side = side[np.isfinite(side).all(axis=1)]
    overhang = run.body.surface.end_overhang
    if overhang > 0.0 and len(side) > 1:
        first, last = side[0] + overhang * (side[0] - side[1]), side[-1] + overhang * (side[-1] - side[-2])
        side = np.vstack([first, side, last])
    return np.vstack([[0.0, side[0, 1]], side, [0.0, side[-1, 1]]]) if len(side) else np.empty((0, 2))


def whole(run: Run, snapshot: Snapshot) -> Array:
    """Return the outline, or none if points that show it are lost."""
    surface = run.body.surface
    shown = np.concatenate([surface.ring[surface.ring >= 0], surface.rear_face.ravel(), surface.impact_face.ravel()])
    return np.empty((0, 2)) if snapshot["lost"][shown].any() else outline(run, snapshot)


def apart(one: Array, other: Array, area: float) -> Apart:
    """Return the difference of two outlines of a rod of half section ``area`` [mm^2]; not-a-number if one is empty."""
    if not (len(one) and len(other)):
        return Apart(np.nan, np.nan)
    between = shapely.area(shapely.symmetric_difference(_section(one), _section(other)))
    distance = shapely.hausdorff_distance(shapely.LineString(one), shapely.LineString(other), densify=DENSE)
    return Apart(float(between) / area, float(distance))


def _section(outline: Array) -> shapely.Geometry:
    """Return the area inside an outline, also where layers have folded over each other."""
    return shapely.make_valid(shapely.Polygon(outline))
